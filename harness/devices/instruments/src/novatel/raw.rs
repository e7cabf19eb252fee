//! Content of the log, in either form.

/// Fields of `RAWIMUSX`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RawImu {
    /// IMU info: bit 0 error, bit 1 encrypted.
    pub info: u8,
    /// Kind of unit.
    pub kind: u8,
    /// GPS week.
    pub week: u16,
    /// Seconds into the week.
    pub seconds: f64,
    /// Status of the unit; its bits depend on the kind.
    pub status: u32,
    /// Velocity increments: z, −y, x, counts.
    pub velocity: [i32; 3],
    /// Rotation increments: z, −y, x, counts.
    pub rotation: [i32; 3],
}
