//! Remainders of a protocol's resolution, carried to the next reading.

/// Remainders of three axes.
///
/// A number is sent as the nearest one that the protocol has, and the remainder is added to the next
/// number. So the sum of the numbers sent follows the sum of the true ones.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Carry {
    left: [f64; 3],
}

impl Carry {
    pub(crate) const fn new() -> Self {
        Self { left: [0.0; 3] }
    }

    /// Sends `value`: `send` turns a number into the form sent and the number that the receiver reads.
    pub(crate) fn send<T>(
        &mut self,
        value: [f64; 3],
        send: impl FnOnce([f64; 3]) -> (T, [f64; 3]),
    ) -> T {
        let meant: [f64; 3] = core::array::from_fn(|axis| value[axis] + self.left[axis]);
        let (sent, read) = send(meant);
        for axis in 0..3 {
            let left = meant[axis] - read[axis];
            // The remainder of a value out of range, or of a NaN, is dropped, as in a real unit.
            self.left[axis] = if left.abs() < 1.0 { left } else { 0.0 };
        }
        sent
    }

    /// Sends 32-bit floats in a unit that is worth `unit`.
    pub(crate) fn floats(&mut self, value: [f64; 3], unit: f64) -> [f32; 3] {
        self.send(value, |meant| {
            let sent = meant.map(|meant| (meant / unit) as f32);
            (sent, sent.map(|sent| f64::from(sent) * unit))
        })
    }

    /// Sends 32-bit integers, which saturate.
    pub(crate) fn counts(&mut self, value: [f64; 3], lsb: f64) -> [i32; 3] {
        self.send(value, |meant| {
            // The cast saturates, and turns NaN into zero.
            let sent = meant.map(|meant| libm::rint(meant / lsb) as i32);
            (sent, sent.map(|sent| f64::from(sent) * lsb))
        })
    }
}
