//! Dependency graph: the order in which values can be computed, and the loops.

/// Returns the strongly connected components of a graph, each in ascending order, sorted so that
/// dependencies come first. `after[v]` are the vertices that need vertex v. (Tarjan 1972, without
/// recursion.)
#[must_use]
pub fn components(after: &[Vec<usize>]) -> Vec<Vec<usize>> {
    const NEW: usize = usize::MAX;
    let count = after.len();
    let (mut index, mut low) = (vec![NEW; count], vec![0; count]);
    let mut on_stack = vec![false; count];
    let (mut stack, mut found) = (Vec::new(), Vec::new());
    let mut next = 0;
    for root in 0..count {
        if index[root] != NEW {
            continue;
        }
        // Vertices on the path from the root, with the index of the next edge to visit.
        let mut path = vec![(root, 0)];
        while let Some((vertex, edge)) = path.pop() {
            if edge == 0 {
                (index[vertex], low[vertex]) = (next, next);
                next += 1;
                stack.push(vertex);
                on_stack[vertex] = true;
            }
            if let Some(&other) = after[vertex].get(edge) {
                path.push((vertex, edge + 1));
                if index[other] == NEW {
                    path.push((other, 0));
                } else if on_stack[other] {
                    low[vertex] = low[vertex].min(index[other]);
                }
                continue;
            }
            if let Some((before, _)) = path.last() {
                low[*before] = low[*before].min(low[vertex]);
            }
            if low[vertex] == index[vertex] {
                let at = stack.iter().rposition(|other| *other == vertex).unwrap_or(0);
                let mut component = stack.split_off(at);
                for member in &component {
                    on_stack[*member] = false;
                }
                component.sort_unstable();
                found.push(component);
            }
        }
    }
    // Components were found last first.
    found.reverse();
    found
}

/// Returns whether a component is a loop: it has several vertices, or one that needs itself.
#[must_use]
pub fn is_loop(component: &[usize], after: &[Vec<usize>]) -> bool {
    match component {
        [vertex] => after[*vertex].contains(vertex),
        _ => true,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
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
}
