//! Strongly connected components against reachability.

use octant_cosim::graph::{components, is_loop};
use proptest::prelude::*;

#[test]
fn circles_are_found_and_come_in_order() {
    // 0 → 1 → 2 → 1, 2 → 3, 4 → 4, 3 → 5
    let after = [vec![1], vec![2], vec![1, 3], vec![5], vec![4], vec![]];
    let found = components(&after);
    assert_eq!(found, [vec![4], vec![0], vec![1, 2], vec![3], vec![5]]);
    let loops: Vec<_> = found.iter().filter(|c| is_loop(c, &after)).collect();
    assert_eq!(loops, [&vec![4], &vec![1, 2]]);
}

/// Computes the vertices that can be reached from each.
fn reach(after: &[Vec<usize>]) -> Vec<Vec<bool>> {
    let n = after.len();
    let mut reach = vec![vec![false; n]; n];
    for (from, to) in after.iter().enumerate() {
        for to in to {
            reach[from][*to] = true;
        }
    }
    for k in 0..n {
        for i in 0..n {
            for j in 0..n {
                reach[i][j] |= reach[i][k] && reach[k][j];
            }
        }
    }
    reach
}

proptest! {
    #[test]
    fn members_reach_each_other_and_order_follows_the_edges(
        edges in proptest::collection::vec((0usize..12, 0usize..12), 0..40)
    ) {
        let mut after = vec![Vec::new(); 12];
        for (from, to) in edges {
            after[from].push(to);
        }
        let found = components(&after);
        let mut place = [usize::MAX; 12];
        for (number, component) in found.iter().enumerate() {
            for member in component {
                prop_assert_eq!(place[*member], usize::MAX);
                place[*member] = number;
            }
        }
        let reach = reach(&after);
        for i in 0..12 {
            prop_assert_ne!(place[i], usize::MAX);
            for j in 0..12 {
                let same = i == j || (reach[i][j] && reach[j][i]);
                prop_assert_eq!(place[i] == place[j], same);
                if reach[i][j] {
                    prop_assert!(place[i] <= place[j]);
                }
            }
        }
    }
}
