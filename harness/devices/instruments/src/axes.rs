//! Mounting of a unit.

/// Mapping of the unit's axes to those of the body.
///
/// The mapping is a signed permutation, so that counts stay counts. A unit mounted slightly askew has
/// misalignments, which the calibration estimates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Axes {
    /// Axis of the unit, and whether it is reversed, for each axis of the body.
    from: [(usize, bool); 3],
}

/// Error of a text that describes no mounting.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum AxesError {
    /// The text doesn't have three words.
    #[error("axes are {found} words, expected are three of x, y, z, -x, -y, -z")]
    Count {
        /// Number of words.
        found: usize,
    },
    /// A word names no axis.
    #[error("axis {number} is none of x, y, z, -x, -y, -z")]
    Word {
        /// Number of the word, from 1.
        number: usize,
    },
    /// An axis occurs twice.
    #[error("an axis of the unit occurs twice")]
    Twice,
    /// The axes are left-handed.
    #[error("the axes are left-handed: change a sign, or two axes")]
    LeftHanded,
}

impl Axes {
    /// Mapping of a unit whose axes are those of the body.
    pub const SAME: Self = Self { from: [(0, false), (1, false), (2, false)] };

    /// Parses a text like `"x -y -z"`: body x is the unit's x, body y is opposite to the unit's y, body
    /// z is opposite to the unit's z.
    ///
    /// # Errors
    /// If the text describes no mounting, or a left-handed one.
    pub fn parse(text: &str) -> Result<Self, AxesError> {
        let found = text.split_whitespace().count();
        if found != 3 {
            return Err(AxesError::Count { found });
        }
        let mut from = [(0, false); 3];
        for (index, (word, axis)) in text.split_whitespace().zip(&mut from).enumerate() {
            let (bare, opposite) = match word.strip_prefix('-') {
                Some(bare) => (bare, true),
                None => (word, false),
            };
            let unit = match bare {
                "x" => 0,
                "y" => 1,
                "z" => 2,
                _ => return Err(AxesError::Word { number: index + 1 }),
            };
            *axis = (unit, opposite);
        }
        let [a, b, c] = from;
        if a.0 == b.0 || b.0 == c.0 || a.0 == c.0 {
            return Err(AxesError::Twice);
        }
        // Right-handed are even permutations with an even number of reversals, and odd ones with an odd
        // number.
        let even = (a.0 + 1) % 3 == b.0;
        let opposites = from.iter().filter(|axis| axis.1).count();
        if even == (opposites % 2 == 1) {
            return Err(AxesError::LeftHanded);
        }
        Ok(Self { from })
    }

    /// Axis of the unit, and whether it is reversed, for each axis of the body.
    #[must_use]
    pub fn names(&self) -> [(&'static str, bool); 3] {
        self.from.map(|(axis, opposite)| (["x", "y", "z"][axis], opposite))
    }

    /// Converts a vector from axes of the unit to axes of the body.
    #[must_use]
    #[inline]
    pub fn to_body(&self, unit: [f64; 3]) -> [f64; 3] {
        self.from.map(|(axis, opposite)| if opposite { -unit[axis] } else { unit[axis] })
    }
}
