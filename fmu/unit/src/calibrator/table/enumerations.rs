//! Types with named values.

use crate::table::enumerations;

enumerations! {
    /// Kind of the reference measurement.
    pub REFERENCE_KIND "ReferenceKind" "What comes with a sample as reference." {
        0 none "No reference is due with this sample.";
        1 velocity "Velocity over ground.";
        2 position "Geodetic position.";
    }
    /// Mode of the core; values as [`octant_sample::Mode`].
    pub MODE "Mode" "Mode of the calibration core." {
        0 aligning "Finding the initial attitude from gravity and Earth rate.";
        1 calibrating "Turning through the positions of the sequence.";
        2 refused "The calibration can't be vouched for; the core navigates no further.";
        3 navigating "Free inertial navigation with compensated sensors.";
        4 done "The procedure is over.";
    }
    /// Method of finding the initial attitude.
    pub ALIGNMENT "AlignmentMethod" "How the initial attitude is found." {
        0 given "Attitude and velocity are handed over.";
        1 coarse "Gravity and Earth rate averaged over the first seconds of the first stop.";
        2 inertial "Turn of gravity in the inertial frame: the base may turn meanwhile.";
    }
    /// Sequences of a calibration; the named ones are those of [`octant_calibration::positions`].
    pub POSITIONS "Positions" "Sequence of positions of a calibration." {
        0 custom "As given by stops.count, stops.azimuth, stops.roll and stops.weight.";
        1 six "The conventional method: six orthogonal attitudes, 17 stops.";
        2 eight "The six with two tilts in different body planes, 19 stops.";
        3 eight_level "The six with the tilts (45, 45) and (45, -45) deg, 19 stops.";
        4 eight_same_plane "A negative control: both tilts in one body plane, 19 stops.";
        5 twelve "Each axis up and down with two headings, 12 stops.";
        6 nineteen "The 19 positions of Xie Bo (2011), 19 stops.";
        7 twenty_four "Four azimuths at six rolls 60 deg apart, 24 stops.";
    }
    /// Rotations while navigating.
    pub ROTATION "Rotation" "Rotation of the gimbals while navigating." {
        0 custom "As given by stops.count, stops.azimuth, stops.roll and stops.weight.";
        1 sixteen "Sixteen moves of 180 deg about both gimbals: most drifts average out.";
        2 none "The gimbals stand at zero.";
        3 tetrahedral "Twelve attitudes, equally long, out and back: of g-dependent drifts the isotropic part is left.";
    }
    /// Method of estimating the parameters.
    pub ESTIMATOR "Estimator" "How the parameters are estimated." {
        0 kalman "Error-state Kalman filter, 39 states, closed loop.";
        1 least_squares "Multi-position least squares on the norm of gravity and Earth rate.";
        2 external_turntable "The angles of a precise external turntable are the reference.";
    }
    /// Form of the system error model.
    pub ERROR_MODEL "ErrorModel" "Form of the filter's system error model." {
        0 phi "Attitude error against the true navigation frame.";
        1 psi "Attitude error against the computer frame.";
    }
    /// Reference of the filter's measurements.
    pub AIDING "AidingReference" "The reference that the filter measures against." {
        0 velocity "Velocity over ground: zero when static, of the dock's reference on a ship.";
        1 position "Position of the dock, from which sway moves the instrument.";
    }
    /// Sway of the base, as the filter sees it.
    pub SWAY "SwayNoise" "What the sway of the base is to the filter." {
        0 white "White noise of the reference, within its standard deviation.";
        1 coloured "Motion of second order on each axis, with estimated period, size and damping.";
    }
    /// Reference of the gyros in the least-squares estimator.
    pub GYRO_REFERENCE "GyroReference"
        "What the least-squares estimator measures the gyros against." {
        0 earth_rate "Norm of Earth rate: gyros that see it.";
        1 rotated_gravity "Gravity turned between static attitudes: gyros that don't.";
    }
    /// Method of finding static intervals.
    pub INTERVALS "StaticIntervals" "How the least-squares estimator finds static intervals." {
        0 commanded "From the procedure: the core commands the gimbals.";
        1 detected "From the data, by windowed standard deviation of specific force.";
    }
    /// Action of a recovery.
    pub RECOVERY "Recovery" "What the core does when the gate has rejected too often in a row." {
        0 widening "Attitude, velocity and position re-open as wide as the innovation says.";
        1 reset "They are set to given standard deviations.";
    }
    /// Motion of the base.
    pub BASE "Base" "What the case of the instrument stands on." {
        0 still "Fixed to the ground.";
        1 moving "On a ship, which moves at most as the bounds say.";
    }
}
