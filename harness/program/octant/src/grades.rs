//! Choice of an instrument by its grade, for `octant new`.

use clap::ValueEnum;
use octant_scenario::{GRADES, GradeSheet};

/// Grade of an instrument, in the order of [`GRADES`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum InstrumentGrade {
    /// Laser gyros, the reference instrument of the method's paper.
    #[value(name = "table-1")]
    Table1,
    /// Laser gyros, navigation grade: Honeywell HG9900.
    NavigationLaser,
    /// Fibre-optic gyros, navigation grade: the inertial grade of Yazdi, Ayazi and Najafi.
    NavigationFibreOptic,
    /// Fibre-optic gyros, tactical grade: Northrop Grumman LN-200.
    TacticalFibreOptic,
    /// MEMS gyros, tactical grade: Sensonor STIM300.
    TacticalMems,
}

impl InstrumentGrade {
    /// Data of this grade.
    #[must_use]
    pub fn sheet(self) -> &'static GradeSheet {
        GRADES[self as usize]
    }
}
