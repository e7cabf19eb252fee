//! Numbers of the lines of a text.

/// Beginnings of the lines of a text, by which a place costs a binary search.
pub(crate) struct Lines {
    ends: Vec<usize>,
}

impl Lines {
    /// Finds the lines of a text.
    pub(crate) fn of(text: &str) -> Self {
        let ends = text.bytes().enumerate().filter(|(_, byte)| *byte == b'\n').map(|(at, _)| at);
        Self { ends: ends.collect() }
    }

    /// Number of the line of a byte, from 1.
    pub(crate) fn number(&self, at: usize) -> usize {
        self.ends.partition_point(|end| *end < at) + 1
    }
}
