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
