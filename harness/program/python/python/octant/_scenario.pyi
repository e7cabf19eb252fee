# Written by tests/scenario-types from the schema of scenarios.

import os
from collections.abc import Iterator, Mapping, MutableMapping, Sequence
from typing import Any, Literal, Union

PathLike = Union[str, "os.PathLike[str]"]

def overrides(changes: Mapping[str, Any] | None, keywords: Mapping[str, Any]) -> list[str]: ...
def settings(scenario: PathLike | Scenario) -> dict[str, Any]: ...

class Section(MutableMapping[str, Any]):
    """A table of a scenario. Keys are attributes and items alike."""

    def __getitem__(self, key: str) -> Any: ...
    def __setitem__(self, key: str, value: Any) -> None: ...
    def __delitem__(self, key: str) -> None: ...
    def __iter__(self) -> Iterator[str]: ...
    def __len__(self) -> int: ...
    def describe(self, key: str = "") -> str:
        """Meaning of a key, what it takes, and its default, in a line; of the table itself without a key."""

class BaselineFurtherAccelAsymmetry(Section):
    """The same of the accelerometers, three. Takes a table with one of estimated, considered. Left out: off."""

    considered: str
    """Their uncertainty of this standard deviation counts, and they are never moved (Schmidt). Takes a ratio
    such as "30 ppm". Left out: another is given."""
    estimated: str
    """The filter estimates and compensates them, from this standard deviation. Takes a ratio such as "30 ppm".
    Left out: another is given."""

class BaselineFurtherAccelBiasTemperature(Section):
    """Temperature coefficients of the accelerometer biases, three. Takes a table with one of estimated,
    considered. Left out: off."""

    considered: str
    """Their uncertainty of this standard deviation counts, and they are never moved (Schmidt). Takes an
    accelerometer bias sensitivity such as "2 ug/K". Left out: another is given."""
    estimated: str
    """The filter estimates and compensates them, from this standard deviation. Takes an accelerometer bias
    sensitivity such as "2 ug/K". Left out: another is given."""

class BaselineFurtherAccelGaussMarkov(Section):
    """First-order Gauss-Markov biases of the accelerometers, three. Takes a table with one of estimated,
    considered. Left out: off."""

    considered: str
    """Their uncertainty of this standard deviation counts, and they are never moved (Schmidt). Takes an
    acceleration such as "100 ug". Left out: another is given."""
    estimated: str
    """The filter estimates and compensates them, from this standard deviation. Takes an acceleration such as
    "100 ug". Left out: another is given."""

class BaselineFurtherAccelLever(Section):
    """Positions of the accelerometers' proof masses from the centre of rotation (size effect), nine. Takes a
    table with one of estimated, considered. Left out: off."""

    considered: str
    """Their uncertainty of this standard deviation counts, and they are never moved (Schmidt). Takes a length
    such as "0.15 m". Left out: another is given."""
    estimated: str
    """The filter estimates and compensates them, from this standard deviation. Takes a length such as "0.15 m".
    Left out: another is given."""

class BaselineFurtherAccelQuadratic(Section):
    """Second-order coefficients of the accelerometers (K2), three. Takes a table with one of estimated,
    considered. Left out: off."""

    considered: str
    """Their uncertainty of this standard deviation counts, and they are never moved (Schmidt). Takes a second-
    order coefficient such as "10 ug/g^2". Left out: another is given."""
    estimated: str
    """The filter estimates and compensates them, from this standard deviation. Takes a second-order coefficient
    such as "10 ug/g^2". Left out: another is given."""

class BaselineFurtherAccelScaleTemperature(Section):
    """Temperature coefficients of the accelerometers' scale factors, three. Takes a table with one of estimated,
    considered. Left out: off."""

    considered: str
    """Their uncertainty of this standard deviation counts, and they are never moved (Schmidt). Takes a scale
    factor sensitivity such as "0.5 ppm/K". Left out: another is given."""
    estimated: str
    """The filter estimates and compensates them, from this standard deviation. Takes a scale factor sensitivity
    such as "0.5 ppm/K". Left out: another is given."""

class BaselineFurtherDeflection(Section):
    """Deflection of the vertical, north and east. On a base at rest it can't be told from a tilt: to be
    considered. Takes a table with one of estimated, considered. Left out: off."""

    considered: str
    """Their uncertainty of this standard deviation counts, and they are never moved (Schmidt). Takes an angle
    such as "40 arcsec". Left out: another is given."""
    estimated: str
    """The filter estimates and compensates them, from this standard deviation. Takes an angle such as "40
    arcsec". Left out: another is given."""

class BaselineFurtherGimbalAnglesEccentricity(Section):
    """Eccentricity of the encoders: cosine and sine of azimuth and of roll, four. Takes a table with one of
    estimated, considered. Left out: off."""

    considered: str
    """Their uncertainty of this standard deviation counts, and they are never moved (Schmidt). Takes an angle
    such as "40 arcsec". Left out: another is given."""
    estimated: str
    """The filter estimates and compensates them, from this standard deviation. Takes an angle such as "40
    arcsec". Left out: another is given."""

class BaselineFurtherGimbalAnglesMounting(Section):
    """Mounting of the body on the inner gimbal, three. z stands for the zero error of the azimuth encoder too.
    Takes a table with one of estimated, considered. Left out: off."""

    considered: str
    """Their uncertainty of this standard deviation counts, and they are never moved (Schmidt). Takes an angle
    such as "40 arcsec". Left out: another is given."""
    estimated: str
    """The filter estimates and compensates them, from this standard deviation. Takes an angle such as "40
    arcsec". Left out: another is given."""

class BaselineFurtherGimbalAnglesNonOrthogonality(Section):
    """Angle by which the gimbal axes miss a right angle, one. Takes a table with one of estimated, considered.
    Left out: off."""

    considered: str
    """Their uncertainty of this standard deviation counts, and they are never moved (Schmidt). Takes an angle
    such as "40 arcsec". Left out: another is given."""
    estimated: str
    """The filter estimates and compensates them, from this standard deviation. Takes an angle such as "40
    arcsec". Left out: another is given."""

class BaselineFurtherGimbalAngles(Section):
    """Gimbal angles as measurements of attitude, once per aiding period while the gimbals rest. For a case at
    rest. Takes a table with sigma, curve, mounting, non_orthogonality, eccentricity. Left out: the angles
    tell the filter nothing."""

    curve: str
    """Rest of an encoder's error curve beyond its eccentricity, one standard deviation: a constant of each stop,
    another one after each move. Takes an angle such as "40 arcsec". Default: "0 arcsec"."""
    @property
    def eccentricity(self) -> BaselineFurtherGimbalAnglesEccentricity:
        """Eccentricity of the encoders: cosine and sine of azimuth and of roll, four. Takes a table with one of
        estimated, considered. Left out: off."""
    @eccentricity.setter
    def eccentricity(self, value: BaselineFurtherGimbalAnglesEccentricity | Mapping[str, Any]) -> None: ...
    @property
    def mounting(self) -> BaselineFurtherGimbalAnglesMounting:
        """Mounting of the body on the inner gimbal, three. z stands for the zero error of the azimuth encoder
        too. Takes a table with one of estimated, considered. Left out: off."""
    @mounting.setter
    def mounting(self, value: BaselineFurtherGimbalAnglesMounting | Mapping[str, Any]) -> None: ...
    @property
    def non_orthogonality(self) -> BaselineFurtherGimbalAnglesNonOrthogonality:
        """Angle by which the gimbal axes miss a right angle, one. Takes a table with one of estimated,
        considered. Left out: off."""
    @non_orthogonality.setter
    def non_orthogonality(self, value: BaselineFurtherGimbalAnglesNonOrthogonality | Mapping[str, Any]) -> None: ...
    sigma: str
    """White noise of a reading, one standard deviation: encoders and wobble of the gimbals. Takes an angle such
    as "40 arcsec". Default: "1 arcsec"."""

class BaselineFurtherGravityAnomaly(Section):
    """True minus normal gravity. On a base at rest it can't be told from a common scale factor of the
    accelerometers: to be considered. Takes a table with one of estimated, considered. Left out: off."""

    considered: str
    """Their uncertainty of this standard deviation counts, and they are never moved (Schmidt). Takes an
    acceleration such as "100 ug". Left out: another is given."""
    estimated: str
    """The filter estimates and compensates them, from this standard deviation. Takes an acceleration such as
    "100 ug". Left out: another is given."""

class BaselineFurtherGyroAsymmetry(Section):
    """Difference of the gyros' scale factors by the sign of the rate, of which this is half, three. Takes a
    table with one of estimated, considered. Left out: off."""

    considered: str
    """Their uncertainty of this standard deviation counts, and they are never moved (Schmidt). Takes a ratio
    such as "30 ppm". Left out: another is given."""
    estimated: str
    """The filter estimates and compensates them, from this standard deviation. Takes a ratio such as "30 ppm".
    Left out: another is given."""

class BaselineFurtherGyroBiasTemperature(Section):
    """Temperature coefficients of the gyro biases, three. Takes a table with one of estimated, considered. Left
    out: off."""

    considered: str
    """Their uncertainty of this standard deviation counts, and they are never moved (Schmidt). Takes a gyro bias
    sensitivity such as "0.0002 deg/h/K". Left out: another is given."""
    estimated: str
    """The filter estimates and compensates them, from this standard deviation. Takes a gyro bias sensitivity
    such as "0.0002 deg/h/K". Left out: another is given."""

class BaselineFurtherGyroGaussMarkov(Section):
    """First-order Gauss-Markov biases of the gyros, three. Takes a table with one of estimated, considered. Left
    out: off."""

    considered: str
    """Their uncertainty of this standard deviation counts, and they are never moved (Schmidt). Takes an angular
    rate such as "0.005 deg/h". Left out: another is given."""
    estimated: str
    """The filter estimates and compensates them, from this standard deviation. Takes an angular rate such as
    "0.005 deg/h". Left out: another is given."""

class BaselineFurtherGyroScaleTemperature(Section):
    """Temperature coefficients of the gyros' scale factors, three. Takes a table with one of estimated,
    considered. Left out: off."""

    considered: str
    """Their uncertainty of this standard deviation counts, and they are never moved (Schmidt). Takes a scale
    factor sensitivity such as "0.5 ppm/K". Left out: another is given."""
    estimated: str
    """The filter estimates and compensates them, from this standard deviation. Takes a scale factor sensitivity
    such as "0.5 ppm/K". Left out: another is given."""

class BaselineFurther(Section):
    """Errors beside the thirty parameters that this filter considers or estimates; {} for none. Takes a table
    with accel_lever, gyro_asymmetry, accel_asymmetry, accel_quadratic, gyro_gauss_markov,
    gyro_correlation_time, accel_gauss_markov, accel_correlation_time, gyro_rate_random_walk, deflection,
    gravity_anomaly, gyro_bias_temperature, gyro_scale_temperature, accel_bias_temperature,
    accel_scale_temperature, temperature_reference_c, gimbal_angles. Left out: as in procedure.calibration."""

    @property
    def accel_asymmetry(self) -> BaselineFurtherAccelAsymmetry:
        """The same of the accelerometers, three. Takes a table with one of estimated, considered. Left out: off."""
    @accel_asymmetry.setter
    def accel_asymmetry(self, value: BaselineFurtherAccelAsymmetry | Mapping[str, Any]) -> None: ...
    @property
    def accel_bias_temperature(self) -> BaselineFurtherAccelBiasTemperature:
        """Temperature coefficients of the accelerometer biases, three. Takes a table with one of estimated,
        considered. Left out: off."""
    @accel_bias_temperature.setter
    def accel_bias_temperature(self, value: BaselineFurtherAccelBiasTemperature | Mapping[str, Any]) -> None: ...
    accel_correlation_time: str
    """Correlation time of accel_gauss_markov. Takes a time such as "12 h". Default: "1 h"."""
    @property
    def accel_gauss_markov(self) -> BaselineFurtherAccelGaussMarkov:
        """First-order Gauss-Markov biases of the accelerometers, three. Takes a table with one of estimated,
        considered. Left out: off."""
    @accel_gauss_markov.setter
    def accel_gauss_markov(self, value: BaselineFurtherAccelGaussMarkov | Mapping[str, Any]) -> None: ...
    @property
    def accel_lever(self) -> BaselineFurtherAccelLever:
        """Positions of the accelerometers' proof masses from the centre of rotation (size effect), nine. Takes a
        table with one of estimated, considered. Left out: off."""
    @accel_lever.setter
    def accel_lever(self, value: BaselineFurtherAccelLever | Mapping[str, Any]) -> None: ...
    @property
    def accel_quadratic(self) -> BaselineFurtherAccelQuadratic:
        """Second-order coefficients of the accelerometers (K2), three. Takes a table with one of estimated,
        considered. Left out: off."""
    @accel_quadratic.setter
    def accel_quadratic(self, value: BaselineFurtherAccelQuadratic | Mapping[str, Any]) -> None: ...
    @property
    def accel_scale_temperature(self) -> BaselineFurtherAccelScaleTemperature:
        """Temperature coefficients of the accelerometers' scale factors, three. Takes a table with one of
        estimated, considered. Left out: off."""
    @accel_scale_temperature.setter
    def accel_scale_temperature(self, value: BaselineFurtherAccelScaleTemperature | Mapping[str, Any]) -> None: ...
    @property
    def deflection(self) -> BaselineFurtherDeflection:
        """Deflection of the vertical, north and east. On a base at rest it can't be told from a tilt: to be
        considered. Takes a table with one of estimated, considered. Left out: off."""
    @deflection.setter
    def deflection(self, value: BaselineFurtherDeflection | Mapping[str, Any]) -> None: ...
    @property
    def gimbal_angles(self) -> BaselineFurtherGimbalAngles:
        """Gimbal angles as measurements of attitude, once per aiding period while the gimbals rest. For a case
        at rest. Takes a table with sigma, curve, mounting, non_orthogonality, eccentricity. Left out: the
        angles tell the filter nothing."""
    @gimbal_angles.setter
    def gimbal_angles(self, value: BaselineFurtherGimbalAngles | Mapping[str, Any]) -> None: ...
    @property
    def gravity_anomaly(self) -> BaselineFurtherGravityAnomaly:
        """True minus normal gravity. On a base at rest it can't be told from a common scale factor of the
        accelerometers: to be considered. Takes a table with one of estimated, considered. Left out: off."""
    @gravity_anomaly.setter
    def gravity_anomaly(self, value: BaselineFurtherGravityAnomaly | Mapping[str, Any]) -> None: ...
    @property
    def gyro_asymmetry(self) -> BaselineFurtherGyroAsymmetry:
        """Difference of the gyros' scale factors by the sign of the rate, of which this is half, three. Takes a
        table with one of estimated, considered. Left out: off."""
    @gyro_asymmetry.setter
    def gyro_asymmetry(self, value: BaselineFurtherGyroAsymmetry | Mapping[str, Any]) -> None: ...
    @property
    def gyro_bias_temperature(self) -> BaselineFurtherGyroBiasTemperature:
        """Temperature coefficients of the gyro biases, three. Takes a table with one of estimated, considered.
        Left out: off."""
    @gyro_bias_temperature.setter
    def gyro_bias_temperature(self, value: BaselineFurtherGyroBiasTemperature | Mapping[str, Any]) -> None: ...
    gyro_correlation_time: str
    """Correlation time of gyro_gauss_markov. Takes a time such as "12 h". Default: "1 h"."""
    @property
    def gyro_gauss_markov(self) -> BaselineFurtherGyroGaussMarkov:
        """First-order Gauss-Markov biases of the gyros, three. Takes a table with one of estimated, considered.
        Left out: off."""
    @gyro_gauss_markov.setter
    def gyro_gauss_markov(self, value: BaselineFurtherGyroGaussMarkov | Mapping[str, Any]) -> None: ...
    gyro_rate_random_walk: str
    """Rate random walk of the gyros: process noise of their biases. With it the biases are no constants, and the
    drift test is off. Takes a rate random walk such as "0.0001 deg/h/sqrt(h)". Default: "0 deg/h/sqrt(h)"."""
    @property
    def gyro_scale_temperature(self) -> BaselineFurtherGyroScaleTemperature:
        """Temperature coefficients of the gyros' scale factors, three. Takes a table with one of estimated,
        considered. Left out: off."""
    @gyro_scale_temperature.setter
    def gyro_scale_temperature(self, value: BaselineFurtherGyroScaleTemperature | Mapping[str, Any]) -> None: ...
    temperature_reference_c: float
    """Temperature of the instrument at which its parameters are as they are estimated, degC. Takes a number that
    is finite. Left out: the first temperature."""

class Baseline(Section):
    """A second method, run on the same seed and noise and compared: what it does differently. Takes a table with
    positions, stops, name, passes, estimator, error_model, g_states, not_estimated, further. Left out: no
    second method."""

    error_model: Literal["phi", "psi"]
    """Form of the filter's system error model. Takes one of "phi", "psi". Left out: as in procedure.calibration."""
    estimator: Literal["kalman", "least-squares", "external-turntable"]
    """How the parameters are estimated. Takes one of "kalman", "least-squares", "external-turntable". Left out:
    as in procedure.calibration."""
    @property
    def further(self) -> BaselineFurther:
        """Errors beside the thirty parameters that this filter considers or estimates; {} for none. Takes a
        table with accel_lever, gyro_asymmetry, accel_asymmetry, accel_quadratic, gyro_gauss_markov,
        gyro_correlation_time, accel_gauss_markov, accel_correlation_time, gyro_rate_random_walk, deflection,
        gravity_anomaly, gyro_bias_temperature, gyro_scale_temperature, accel_bias_temperature,
        accel_scale_temperature, temperature_reference_c, gimbal_angles. Left out: as in
        procedure.calibration."""
    @further.setter
    def further(self, value: BaselineFurther | Mapping[str, Any]) -> None: ...
    g_states: bool
    """Whether the filter estimates the g-dependent biases. Takes true or false. Left out: as in
    procedure.calibration."""
    name: str
    """Name of this sequence of one's own; other stops don't inherit the first one's. Takes a text in quotes.
    Left out: as in procedure.calibration."""
    not_estimated: Sequence[Literal["gyro_bias", "gyro_scale", "gyro_misalignment", "g_dependent", "accel_bias", "accel_scale", "accel_misalignment"]]
    """Further groups that the filter does not estimate. Takes a list of some of gyro_bias, gyro_scale,
    gyro_misalignment, g_dependent, accel_bias, accel_scale, accel_misalignment. Left out: as in
    procedure.calibration."""
    passes: int
    """How often the sequence is walked. Takes a whole number from 1 to 1000. Left out: as in
    procedure.calibration."""
    positions: Literal["six", "eight", "eight-level", "eight-same-plane", "twelve", "nineteen", "twenty-four"]
    """Named sequence of positions. Takes one of "six", "eight", "eight-level", "eight-same-plane", "twelve",
    "nineteen", "twenty-four". Left out: as in procedure.calibration."""
    stops: Sequence[Mapping[str, Any]]
    """A sequence of one's own. Takes an array of tables with azimuth, roll, weight. Left out: as in
    procedure.calibration."""

class Decision(Section):
    """What a value near its limit comes to, by how uncertain its reference is. Takes a table with rule,
    position, uncertainties."""

    position: str
    """Expanded uncertainty (95 %) of the reference position, in each direction. Takes a length such as "0.15 m".
    Left out: not stated: exact where it is simulated."""
    rule: Literal["guard-band", "simple-acceptance"]
    """What a value comes to that its reference can't tell from its limit (JCGM 106). Takes one of "guard-band",
    "simple-acceptance". Left out: guard-band; of simulated truth the band is zero."""
    uncertainties: Sequence[Mapping[str, Any]]
    """Expanded uncertainties (95 %) of what single measures are held against, such as a turntable. Takes an
    array of tables with measure, uncertainty. Left out: none is stated."""

class Display(Section):
    """Units of errors in report and terminal. Files for machines keep theirs. Takes a table with position,
    attitude, velocity."""

    attitude: Literal["arcmin", "deg", "arcsec", "mrad"]
    """Unit of attitude errors. Takes one of "arcmin", "deg", "arcsec", "mrad". Default: "arcmin"."""
    position: Literal["arcmin", "nmi", "m", "km"]
    """Unit of position errors. Takes one of "arcmin", "nmi", "m", "km". Default: "arcmin"."""
    velocity: Literal["m/s", "kn", "cm/s"]
    """Unit of velocity errors. Takes one of "m/s", "kn", "cm/s". Default: "m/s"."""

class EndpointFmuMapAccelerometer(Section):
    """Accelerometers: specific force or increments. Takes a table with specific_force, delta_velocity. Left out:
    the variable of the channel's own name, where the FMU has it."""

    delta_velocity: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """Velocity increments over the sample's interval, x y z. Takes the name of an array variable, or 3 entries,
    each the name of a variable, or a table with variable (and unit, scale) or constant. Left out: the
    variable of the channel's own name, where the FMU has it."""
    specific_force: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """Specific force, x y z (at rest it points up), taken as constant over the sample's interval. Takes the name
    of an array variable, or 3 entries, each the name of a variable, or a table with variable (and unit,
    scale) or constant. Left out: the variable of the channel's own name, where the FMU has it."""

class EndpointFmuMapAnswer(Section):
    """Which sample is answered; left out: the one that was set. Takes a table with sequence, device_time_ns.
    Left out: the variable of the channel's own name, where the FMU has it."""

    device_time_ns: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """Stamp of the sample that is answered, ns. Takes the name of a variable, or a table with variable (and
    unit, scale) or constant. Left out: the variable of the channel's own name, where the FMU has it."""
    sequence: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """Number of the sample that is answered. Takes the name of a variable, or a table with variable (and unit,
    scale) or constant. Left out: the variable of the channel's own name, where the FMU has it."""

class EndpointFmuMapFilter(Section):
    """The measurement of a calibration. Takes a table with nis, measured. Left out: the variable of the
    channel's own name, where the FMU has it."""

    measured: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """Whether there is a measurement with this sample. Takes the name of a variable, or a table with variable
    (and unit, scale) or constant. Left out: the variable of the channel's own name, where the FMU has it."""
    nis: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """Normalized innovation squared of the measurement (three axes). Takes the name of a variable, or a table
    with variable (and unit, scale) or constant. Left out: the variable of the channel's own name, where the
    FMU has it."""

class EndpointFmuMapGimbal(Section):
    """Encoders. Takes a table with azimuth, roll. Left out: the variable of the channel's own name, where the
    FMU has it."""

    azimuth: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """Angle of the inner gimbal at the stamp, cumulative. Takes the name of a variable, or a table with variable
    (and unit, scale) or constant. Left out: the variable of the channel's own name, where the FMU has it."""
    roll: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """Angle of the outer gimbal at the stamp, cumulative. Takes the name of a variable, or a table with variable
    (and unit, scale) or constant. Left out: the variable of the channel's own name, where the FMU has it."""

class EndpointFmuMapGimbalCommand(Section):
    """Outputs of the FMU: where it wants the gimbals. Takes a table with azimuth, roll. Left out: the variable
    of the channel's own name, where the FMU has it."""

    azimuth: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """Set point of the inner gimbal, cumulative. Takes the name of a variable, or a table with variable (and
    unit, scale) or constant. Left out: the variable of the channel's own name, where the FMU has it."""
    roll: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """Set point of the outer gimbal, cumulative. Takes the name of a variable, or a table with variable (and
    unit, scale) or constant. Left out: the variable of the channel's own name, where the FMU has it."""

class EndpointFmuMapGyro(Section):
    """Gyros: rates or increments. Takes a table with rate, delta_theta. Left out: the variable of the channel's
    own name, where the FMU has it."""

    delta_theta: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """Angle increments over the sample's interval, x y z. Takes the name of an array variable, or 3 entries,
    each the name of a variable, or a table with variable (and unit, scale) or constant. Left out: the
    variable of the channel's own name, where the FMU has it."""
    rate: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """Angular rate of the body, x y z, taken as constant over the sample's interval. Takes the name of an array
    variable, or 3 entries, each the name of a variable, or a table with variable (and unit, scale) or
    constant. Left out: the variable of the channel's own name, where the FMU has it."""

class EndpointFmuMapImu(Section):
    """Flags and stamps of samples. Takes a table with valid, status, sequence, device_time_ns. Left out: the
    variable of the channel's own name, where the FMU has it."""

    device_time_ns: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """Stamp of the sample, ns since the start of the first interval. Takes the name of a variable, or a table
    with variable (and unit, scale) or constant. Left out: the variable of the channel's own name, where the
    FMU has it."""
    sequence: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """Number of the sample, from 1. Takes the name of a variable, or a table with variable (and unit, scale) or
    constant. Left out: the variable of the channel's own name, where the FMU has it."""
    status: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """Flags of the sample: 1 gyro saturated, 2 accelerometer saturated, 4 gimbal angles invalid, 8 inertial
    counts invalid. Takes the name of a variable, or a table with variable (and unit, scale) or constant. Left
    out: the variable of the channel's own name, where the FMU has it."""
    valid: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """Whether there is a sample; without one none is delivered. Takes the name of a variable, or a table with
    variable (and unit, scale) or constant. Left out: the variable of the channel's own name, where the FMU
    has it."""

class EndpointFmuMapNavigation(Section):
    """The navigation solution. Takes a table with latitude, longitude, height, velocity, attitude. Left out: the
    variable of the channel's own name, where the FMU has it."""

    attitude: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """Attitude of the navigation solution as a quaternion w x y z that takes a vector in body into north, east,
    down. Takes the name of an array variable, or 4 entries, each the name of a variable, or a table with
    variable (and unit, scale) or constant. Left out: the variable of the channel's own name, where the FMU
    has it."""
    height: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """Height of the navigation solution above the ellipsoid. Takes the name of a variable, or a table with
    variable (and unit, scale) or constant. Left out: the variable of the channel's own name, where the FMU
    has it."""
    latitude: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """Geodetic latitude of the navigation solution. Takes the name of a variable, or a table with variable (and
    unit, scale) or constant. Left out: the variable of the channel's own name, where the FMU has it."""
    longitude: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """Longitude of the navigation solution. Takes the name of a variable, or a table with variable (and unit,
    scale) or constant. Left out: the variable of the channel's own name, where the FMU has it."""
    velocity: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """Velocity over ground of the navigation solution: north, east, down. Takes the name of an array variable,
    or 3 entries, each the name of a variable, or a table with variable (and unit, scale) or constant. Left
    out: the variable of the channel's own name, where the FMU has it."""

class EndpointFmuMapParameters(Section):
    """Estimated parameters. Takes a table with revision, gyro_bias, gyro_scale, gyro_misalignment, g_dependent,
    accel_bias, accel_scale, accel_misalignment. Left out: the variable of the channel's own name, where the
    FMU has it."""

    accel_bias: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """Estimated accelerometer biases. Takes the name of an array variable, or 3 entries, each the name of a
    variable, or a table with variable (and unit, scale) or constant. Left out: the variable of the channel's
    own name, where the FMU has it."""
    accel_misalignment: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """Estimated accelerometer misalignments: yx, zx, zy. Takes the name of an array variable, or 3 entries, each
    the name of a variable, or a table with variable (and unit, scale) or constant. Left out: the variable of
    the channel's own name, where the FMU has it."""
    accel_scale: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """Estimated accelerometer scale factor errors. Takes the name of an array variable, or 3 entries, each the
    name of a variable, or a table with variable (and unit, scale) or constant. Left out: the variable of the
    channel's own name, where the FMU has it."""
    g_dependent: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """Estimated g-dependent gyro biases by rows. Takes the name of an array variable, or 9 entries, each the
    name of a variable, or a table with variable (and unit, scale) or constant. Left out: the variable of the
    channel's own name, where the FMU has it."""
    gyro_bias: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """Estimated gyro biases. Takes the name of an array variable, or 3 entries, each the name of a variable, or
    a table with variable (and unit, scale) or constant. Left out: the variable of the channel's own name,
    where the FMU has it."""
    gyro_misalignment: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """Estimated gyro misalignments: xy, xz, yx, yz, zx, zy. Takes the name of an array variable, or 6 entries,
    each the name of a variable, or a table with variable (and unit, scale) or constant. Left out: the
    variable of the channel's own name, where the FMU has it."""
    gyro_scale: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """Estimated gyro scale factor errors. Takes the name of an array variable, or 3 entries, each the name of a
    variable, or a table with variable (and unit, scale) or constant. Left out: the variable of the channel's
    own name, where the FMU has it."""
    revision: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """Number of times that the estimated parameters have changed; left out, they are looked at with every
    sample. Takes the name of a variable, or a table with variable (and unit, scale) or constant. Left out:
    the variable of the channel's own name, where the FMU has it."""

class EndpointFmuMapReference(Section):
    """The reference of a calibration. Takes a table with kind, valid, velocity, latitude, longitude, height,
    age_ns. Left out: the variable of the channel's own name, where the FMU has it."""

    age_ns: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """Stamp of the sample minus that of its reference, ns. Takes the name of a variable, or a table with
    variable (and unit, scale) or constant. Left out: the variable of the channel's own name, where the FMU
    has it."""
    height: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """Height above the ellipsoid that the reference measured. Takes the name of a variable, or a table with
    variable (and unit, scale) or constant. Left out: the variable of the channel's own name, where the FMU
    has it."""
    kind: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """Whether a reference goes with the sample: 0 none, 1 velocity, 2 position. Takes the name of a variable, or
    a table with variable (and unit, scale) or constant. Left out: the variable of the channel's own name,
    where the FMU has it."""
    latitude: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """Geodetic latitude that the reference measured. Takes the name of a variable, or a table with variable (and
    unit, scale) or constant. Left out: the variable of the channel's own name, where the FMU has it."""
    longitude: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """Longitude that the reference measured. Takes the name of a variable, or a table with variable (and unit,
    scale) or constant. Left out: the variable of the channel's own name, where the FMU has it."""
    valid: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """Whether a reference goes with the sample. Takes the name of a variable, or a table with variable (and
    unit, scale) or constant. Left out: the variable of the channel's own name, where the FMU has it."""
    velocity: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """Velocity over ground that the reference measured: north, east, down. Takes the name of an array variable,
    or 3 entries, each the name of a variable, or a table with variable (and unit, scale) or constant. Left
    out: the variable of the channel's own name, where the FMU has it."""

class EndpointFmuMapSigma(Section):
    """Standard deviations of the estimated parameters. Takes a table with gyro_bias, gyro_scale,
    gyro_misalignment, g_dependent, accel_bias, accel_scale, accel_misalignment. Left out: the variable of the
    channel's own name, where the FMU has it."""

    accel_bias: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """1σ of the accelerometer biases. Takes the name of an array variable, or 3 entries, each the name of a
    variable, or a table with variable (and unit, scale) or constant. Left out: the variable of the channel's
    own name, where the FMU has it."""
    accel_misalignment: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """1σ of the accelerometer misalignments. Takes the name of an array variable, or 3 entries, each the name of
    a variable, or a table with variable (and unit, scale) or constant. Left out: the variable of the
    channel's own name, where the FMU has it."""
    accel_scale: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """1σ of the accelerometer scale factor errors. Takes the name of an array variable, or 3 entries, each the
    name of a variable, or a table with variable (and unit, scale) or constant. Left out: the variable of the
    channel's own name, where the FMU has it."""
    g_dependent: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """1σ of the g-dependent gyro biases. Takes the name of an array variable, or 9 entries, each the name of a
    variable, or a table with variable (and unit, scale) or constant. Left out: the variable of the channel's
    own name, where the FMU has it."""
    gyro_bias: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """1σ of the gyro biases. Takes the name of an array variable, or 3 entries, each the name of a variable, or
    a table with variable (and unit, scale) or constant. Left out: the variable of the channel's own name,
    where the FMU has it."""
    gyro_misalignment: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """1σ of the gyro misalignments. Takes the name of an array variable, or 6 entries, each the name of a
    variable, or a table with variable (and unit, scale) or constant. Left out: the variable of the channel's
    own name, where the FMU has it."""
    gyro_scale: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """1σ of the gyro scale factor errors. Takes the name of an array variable, or 3 entries, each the name of a
    variable, or a table with variable (and unit, scale) or constant. Left out: the variable of the channel's
    own name, where the FMU has it."""

class EndpointFmuMap(Section):
    """Which variable of the FMU is what. Units are converted as the FMU's description says; a name after a minus
    sign is negated. Takes a table with gyro, accelerometer, gimbal, imu, reference, gimbal_command, mode,
    stop, moving, navigation, filter, health, answer, parameters, sigma. Left out: the variable of the
    channel's own name, where the FMU has it."""

    @property
    def accelerometer(self) -> EndpointFmuMapAccelerometer:
        """Accelerometers: specific force or increments. Takes a table with specific_force, delta_velocity. Left
        out: the variable of the channel's own name, where the FMU has it."""
    @accelerometer.setter
    def accelerometer(self, value: EndpointFmuMapAccelerometer | Mapping[str, Any]) -> None: ...
    @property
    def answer(self) -> EndpointFmuMapAnswer:
        """Which sample is answered; left out: the one that was set. Takes a table with sequence, device_time_ns.
        Left out: the variable of the channel's own name, where the FMU has it."""
    @answer.setter
    def answer(self, value: EndpointFmuMapAnswer | Mapping[str, Any]) -> None: ...
    @property
    def filter(self) -> EndpointFmuMapFilter:
        """The measurement of a calibration. Takes a table with nis, measured. Left out: the variable of the
        channel's own name, where the FMU has it."""
    @filter.setter
    def filter(self, value: EndpointFmuMapFilter | Mapping[str, Any]) -> None: ...
    @property
    def gimbal(self) -> EndpointFmuMapGimbal:
        """Encoders. Takes a table with azimuth, roll. Left out: the variable of the channel's own name, where
        the FMU has it."""
    @gimbal.setter
    def gimbal(self, value: EndpointFmuMapGimbal | Mapping[str, Any]) -> None: ...
    @property
    def gimbal_command(self) -> EndpointFmuMapGimbalCommand:
        """Outputs of the FMU: where it wants the gimbals. Takes a table with azimuth, roll. Left out: the
        variable of the channel's own name, where the FMU has it."""
    @gimbal_command.setter
    def gimbal_command(self, value: EndpointFmuMapGimbalCommand | Mapping[str, Any]) -> None: ...
    @property
    def gyro(self) -> EndpointFmuMapGyro:
        """Gyros: rates or increments. Takes a table with rate, delta_theta. Left out: the variable of the
        channel's own name, where the FMU has it."""
    @gyro.setter
    def gyro(self, value: EndpointFmuMapGyro | Mapping[str, Any]) -> None: ...
    health: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """Health flags in bits, as docs/recording.md numbers them. Takes the name of a variable, or a table with
    variable (and unit, scale) or constant. Left out: the variable of the channel's own name, where the FMU
    has it."""
    @property
    def imu(self) -> EndpointFmuMapImu:
        """Flags and stamps of samples. Takes a table with valid, status, sequence, device_time_ns. Left out: the
        variable of the channel's own name, where the FMU has it."""
    @imu.setter
    def imu(self, value: EndpointFmuMapImu | Mapping[str, Any]) -> None: ...
    mode: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """Mode of the core: 0 aligning, 1 calibrating, 2 refused, 3 navigating, 4 done, or as the codes of modes
    say. Takes the name of a variable, or a table with variable (and unit, scale) or constant. Left out: the
    variable of the channel's own name, where the FMU has it."""
    moving: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """Whether the gimbals are on their way. Takes the name of a variable, or a table with variable (and unit,
    scale) or constant. Left out: the variable of the channel's own name, where the FMU has it."""
    @property
    def navigation(self) -> EndpointFmuMapNavigation:
        """The navigation solution. Takes a table with latitude, longitude, height, velocity, attitude. Left out:
        the variable of the channel's own name, where the FMU has it."""
    @navigation.setter
    def navigation(self, value: EndpointFmuMapNavigation | Mapping[str, Any]) -> None: ...
    @property
    def parameters(self) -> EndpointFmuMapParameters:
        """Estimated parameters. Takes a table with revision, gyro_bias, gyro_scale, gyro_misalignment,
        g_dependent, accel_bias, accel_scale, accel_misalignment. Left out: the variable of the channel's own
        name, where the FMU has it."""
    @parameters.setter
    def parameters(self, value: EndpointFmuMapParameters | Mapping[str, Any]) -> None: ...
    @property
    def reference(self) -> EndpointFmuMapReference:
        """The reference of a calibration. Takes a table with kind, valid, velocity, latitude, longitude, height,
        age_ns. Left out: the variable of the channel's own name, where the FMU has it."""
    @reference.setter
    def reference(self, value: EndpointFmuMapReference | Mapping[str, Any]) -> None: ...
    @property
    def sigma(self) -> EndpointFmuMapSigma:
        """Standard deviations of the estimated parameters. Takes a table with gyro_bias, gyro_scale,
        gyro_misalignment, g_dependent, accel_bias, accel_scale, accel_misalignment. Left out: the variable of
        the channel's own name, where the FMU has it."""
    @sigma.setter
    def sigma(self, value: EndpointFmuMapSigma | Mapping[str, Any]) -> None: ...
    stop: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """Stop that the gimbals are at or move to, from 0. Takes the name of a variable, or a table with variable
    (and unit, scale) or constant. Left out: the variable of the channel's own name, where the FMU has it."""

class EndpointFmuModes(Section):
    """Which values of the variable of map.mode mean what. Takes a table with aligning, calibrating, refused,
    navigating, done. Left out: 0, 1, 2, 3, 4 in the order aligning, calibrating, refused, navigating, done."""

    aligning: int | str | Sequence[int | str]
    """Values that mean this mode. Takes a whole number or the name of an enumeration's item, or an array of
    them. Left out: no value means it."""
    calibrating: int | str | Sequence[int | str]
    """Values that mean this mode. Takes a whole number or the name of an enumeration's item, or an array of
    them. Left out: no value means it."""
    done: int | str | Sequence[int | str]
    """Values that mean this mode. Takes a whole number or the name of an enumeration's item, or an array of
    them. Left out: no value means it."""
    navigating: int | str | Sequence[int | str]
    """Values that mean this mode. Takes a whole number or the name of an enumeration's item, or an array of
    them. Left out: no value means it."""
    refused: int | str | Sequence[int | str]
    """Values that mean this mode. Takes a whole number or the name of an enumeration's item, or an array of
    them. Left out: no value means it."""

class EndpointFmu(Section):
    """How the FMU of endpoint.uri is run, and what its variables are. Takes a table with interface, process,
    time_limit, allow_tool, tolerance, parameters, map, modes. Default: fmu: the defaults of its keys."""

    allow_tool: bool
    """Whether the FMU is run although it needs the tool that made it, which has to be installed. Takes true or
    false. Default: false."""
    interface: Literal["auto", "co-simulation", "model-exchange"]
    """Interface type of the FMU. Takes one of "auto", "co-simulation", "model-exchange". Default: "auto"."""
    @property
    def map(self) -> EndpointFmuMap:
        """Which variable of the FMU is what. Units are converted as the FMU's description says; a name after a
        minus sign is negated. Takes a table with gyro, accelerometer, gimbal, imu, reference, gimbal_command,
        mode, stop, moving, navigation, filter, health, answer, parameters, sigma. Left out: the variable of
        the channel's own name, where the FMU has it."""
    @map.setter
    def map(self, value: EndpointFmuMap | Mapping[str, Any]) -> None: ...
    @property
    def modes(self) -> EndpointFmuModes:
        """Which values of the variable of map.mode mean what. Takes a table with aligning, calibrating, refused,
        navigating, done. Left out: 0, 1, 2, 3, 4 in the order aligning, calibrating, refused, navigating,
        done."""
    @modes.setter
    def modes(self, value: EndpointFmuModes | Mapping[str, Any]) -> None: ...
    parameters: Mapping[str, Any]
    """Values of the FMU's parameters, and of inputs that are held: a number is in the variable's own unit, a
    quantity is converted into it. Takes a table of names and values. Left out: nothing is set."""
    process: Literal["own", "shared"]
    """Where the FMU runs. Takes one of "own", "shared". Default: "own"."""
    time_limit: str
    """Wall time that one call of the FMU may take; longer, and it counts as hung. Takes a time such as "12 h".
    Default: in a process of its own: "10 s"; in the shared one: none, nothing can end a call."""
    tolerance: float
    """Relative tolerance of the FMU's solver, or of Octant's in model exchange. Takes a number from 1e-14 to
    0.1. Left out: that of the FMU's default experiment."""

class EndpointLink(Section):
    """What is waited for how long, of the device at endpoint.uri. Takes a table with hello, answer, repeat,
    reconnect. Default: with a device: the defaults of its keys."""

    answer: str
    """How long an answer is waited for, however often it is asked for; then the device is gone. Takes a time
    such as "12 h". Default: "5 s"."""
    hello: str
    """How long the device's first hello is waited for, such as while it is switched on. Takes a time such as "12
    h". Default: "10 s"."""
    reconnect: str
    """How long a port that was unplugged is waited for; the device has to have kept its state. 0 s: the run ends
    at once. Takes a time such as "12 h". Default: "0 s"."""
    repeat: str
    """After how long an answer that isn't there is asked for again. Takes a time such as "12 h". Default: "200
    ms"."""

class Endpoint(Section):
    """Where the core runs. Takes a table with uri, fmu, link."""

    @property
    def fmu(self) -> EndpointFmu:
        """How the FMU of endpoint.uri is run, and what its variables are. Takes a table with interface, process,
        time_limit, allow_tool, tolerance, parameters, map, modes. Default: fmu: the defaults of its keys."""
    @fmu.setter
    def fmu(self, value: EndpointFmu | Mapping[str, Any]) -> None: ...
    @property
    def link(self) -> EndpointLink:
        """What is waited for how long, of the device at endpoint.uri. Takes a table with hello, answer, repeat,
        reconnect. Default: with a device: the defaults of its keys."""
    @link.setter
    def link(self, value: EndpointLink | Mapping[str, Any]) -> None: ...
    uri: str
    """Where the core runs. A file name is relative to the scenario, and may start with ${OCTANT_RECORDINGS}.
    Takes one of "in-process", "fmu", "serial", "can", "slcan", "udp", "tcp", "exec". Default: "in-process"."""

class ImuAccelBias(Section):
    """Constant accelerometer biases. Takes a table with one of normal, uniform, constant. Default: {"normal":
    "100 ug"}."""

    constant: Sequence[str]
    """The values themselves: x, y, z. Takes an array of 3, each an acceleration such as "100 ug". Left out:
    another is given."""
    normal: str
    """Drawn from a normal distribution of this standard deviation, each entry alone. Takes an acceleration such
    as "100 ug". Left out: another is given."""
    uniform: str
    """Drawn evenly within plus and minus this half width, each entry alone. Takes an acceleration such as "100
    ug". Left out: another is given."""

class ImuAccelMisalignment(Section):
    """Accelerometer misalignments; the accelerometers define the body frame. Takes a table with one of normal,
    uniform, constant. Default: {"uniform": "40 arcsec"}."""

    constant: Sequence[str]
    """The values themselves: yx, zx, zy. Takes an array of 3, each an angle such as "40 arcsec". Left out:
    another is given."""
    normal: str
    """Drawn from a normal distribution of this standard deviation, each entry alone. Takes an angle such as "40
    arcsec". Left out: another is given."""
    uniform: str
    """Drawn evenly within plus and minus this half width, each entry alone. Takes an angle such as "40 arcsec".
    Left out: another is given."""

class ImuAccelScale(Section):
    """Accelerometer scale factor errors. Takes a table with one of normal, uniform, constant. Default:
    {"uniform": "30 ppm"}."""

    constant: Sequence[str]
    """The values themselves: x, y, z. Takes an array of 3, each a ratio such as "30 ppm". Left out: another is
    given."""
    normal: str
    """Drawn from a normal distribution of this standard deviation, each entry alone. Takes a ratio such as "30
    ppm". Left out: another is given."""
    uniform: str
    """Drawn evenly within plus and minus this half width, each entry alone. Takes a ratio such as "30 ppm". Left
    out: another is given."""

class ImuExtensionsAccelGaussMarkov(Section):
    """First-order Gauss-Markov accelerometer bias. Takes a table with sigma, correlation_time. Left out: none."""

    correlation_time: str
    """Correlation time. Takes a time such as "12 h"."""
    sigma: str
    """Stationary standard deviation. Takes an acceleration such as "100 ug"."""

class ImuExtensionsDrawnAccelAsymmetry(Section):
    """Asymmetry of the accelerometers' scale factors, three. Takes a table with one of normal, uniform. Left
    out: as given."""

    normal: str
    """Drawn from a normal distribution of this standard deviation, each entry alone. Takes a ratio such as "30
    ppm". Left out: another is given."""
    uniform: str
    """Drawn evenly within plus and minus this half width, each entry alone. Takes a ratio such as "30 ppm". Left
    out: another is given."""

class ImuExtensionsDrawnAccelBiasTemperature(Section):
    """Temperature coefficients of the accelerometer biases, three. Takes a table with one of normal, uniform.
    Left out: as given."""

    normal: str
    """Drawn from a normal distribution of this standard deviation, each entry alone. Takes an accelerometer bias
    sensitivity such as "2 ug/K". Left out: another is given."""
    uniform: str
    """Drawn evenly within plus and minus this half width, each entry alone. Takes an accelerometer bias
    sensitivity such as "2 ug/K". Left out: another is given."""

class ImuExtensionsDrawnAccelQuadratic(Section):
    """Second-order coefficients of the accelerometers, three. Takes a table with one of normal, uniform. Left
    out: as given."""

    normal: str
    """Drawn from a normal distribution of this standard deviation, each entry alone. Takes a second-order
    coefficient such as "10 ug/g^2". Left out: another is given."""
    uniform: str
    """Drawn evenly within plus and minus this half width, each entry alone. Takes a second-order coefficient
    such as "10 ug/g^2". Left out: another is given."""

class ImuExtensionsDrawnAccelScaleTemperature(Section):
    """Temperature coefficients of the accelerometers' scale factors, three. Takes a table with one of normal,
    uniform. Left out: as given."""

    normal: str
    """Drawn from a normal distribution of this standard deviation, each entry alone. Takes a scale factor
    sensitivity such as "0.5 ppm/K". Left out: another is given."""
    uniform: str
    """Drawn evenly within plus and minus this half width, each entry alone. Takes a scale factor sensitivity
    such as "0.5 ppm/K". Left out: another is given."""

class ImuExtensionsDrawnGyroAsymmetry(Section):
    """Asymmetry of the gyros' scale factors, three. Takes a table with one of normal, uniform. Left out: as
    given."""

    normal: str
    """Drawn from a normal distribution of this standard deviation, each entry alone. Takes a ratio such as "30
    ppm". Left out: another is given."""
    uniform: str
    """Drawn evenly within plus and minus this half width, each entry alone. Takes a ratio such as "30 ppm". Left
    out: another is given."""

class ImuExtensionsDrawnGyroBiasTemperature(Section):
    """Temperature coefficients of the gyro biases, three. Takes a table with one of normal, uniform. Left out:
    as given."""

    normal: str
    """Drawn from a normal distribution of this standard deviation, each entry alone. Takes a gyro bias
    sensitivity such as "0.0002 deg/h/K". Left out: another is given."""
    uniform: str
    """Drawn evenly within plus and minus this half width, each entry alone. Takes a gyro bias sensitivity such
    as "0.0002 deg/h/K". Left out: another is given."""

class ImuExtensionsDrawnGyroScaleTemperature(Section):
    """Temperature coefficients of the gyros' scale factors, three. Takes a table with one of normal, uniform.
    Left out: as given."""

    normal: str
    """Drawn from a normal distribution of this standard deviation, each entry alone. Takes a scale factor
    sensitivity such as "0.5 ppm/K". Left out: another is given."""
    uniform: str
    """Drawn evenly within plus and minus this half width, each entry alone. Takes a scale factor sensitivity
    such as "0.5 ppm/K". Left out: another is given."""

class ImuExtensionsDrawnLeverArm(Section):
    """Positions of the accelerometers, nine. Takes a table with one of normal, uniform. Left out: as given."""

    normal: str
    """Drawn from a normal distribution of this standard deviation, each entry alone. Takes a length such as
    "0.15 m". Left out: another is given."""
    uniform: str
    """Drawn evenly within plus and minus this half width, each entry alone. Takes a length such as "0.15 m".
    Left out: another is given."""

class ImuExtensionsDrawn(Section):
    """Errors that the seed draws, each group from its own stream; they add to the values given above. Takes a
    table with lever_arm, gyro_asymmetry, accel_asymmetry, accel_quadratic, gyro_bias_temperature,
    gyro_scale_temperature, accel_bias_temperature, accel_scale_temperature. Left out: nothing is drawn."""

    @property
    def accel_asymmetry(self) -> ImuExtensionsDrawnAccelAsymmetry:
        """Asymmetry of the accelerometers' scale factors, three. Takes a table with one of normal, uniform. Left
        out: as given."""
    @accel_asymmetry.setter
    def accel_asymmetry(self, value: ImuExtensionsDrawnAccelAsymmetry | Mapping[str, Any]) -> None: ...
    @property
    def accel_bias_temperature(self) -> ImuExtensionsDrawnAccelBiasTemperature:
        """Temperature coefficients of the accelerometer biases, three. Takes a table with one of normal,
        uniform. Left out: as given."""
    @accel_bias_temperature.setter
    def accel_bias_temperature(self, value: ImuExtensionsDrawnAccelBiasTemperature | Mapping[str, Any]) -> None: ...
    @property
    def accel_quadratic(self) -> ImuExtensionsDrawnAccelQuadratic:
        """Second-order coefficients of the accelerometers, three. Takes a table with one of normal, uniform.
        Left out: as given."""
    @accel_quadratic.setter
    def accel_quadratic(self, value: ImuExtensionsDrawnAccelQuadratic | Mapping[str, Any]) -> None: ...
    @property
    def accel_scale_temperature(self) -> ImuExtensionsDrawnAccelScaleTemperature:
        """Temperature coefficients of the accelerometers' scale factors, three. Takes a table with one of
        normal, uniform. Left out: as given."""
    @accel_scale_temperature.setter
    def accel_scale_temperature(self, value: ImuExtensionsDrawnAccelScaleTemperature | Mapping[str, Any]) -> None: ...
    @property
    def gyro_asymmetry(self) -> ImuExtensionsDrawnGyroAsymmetry:
        """Asymmetry of the gyros' scale factors, three. Takes a table with one of normal, uniform. Left out: as
        given."""
    @gyro_asymmetry.setter
    def gyro_asymmetry(self, value: ImuExtensionsDrawnGyroAsymmetry | Mapping[str, Any]) -> None: ...
    @property
    def gyro_bias_temperature(self) -> ImuExtensionsDrawnGyroBiasTemperature:
        """Temperature coefficients of the gyro biases, three. Takes a table with one of normal, uniform. Left
        out: as given."""
    @gyro_bias_temperature.setter
    def gyro_bias_temperature(self, value: ImuExtensionsDrawnGyroBiasTemperature | Mapping[str, Any]) -> None: ...
    @property
    def gyro_scale_temperature(self) -> ImuExtensionsDrawnGyroScaleTemperature:
        """Temperature coefficients of the gyros' scale factors, three. Takes a table with one of normal,
        uniform. Left out: as given."""
    @gyro_scale_temperature.setter
    def gyro_scale_temperature(self, value: ImuExtensionsDrawnGyroScaleTemperature | Mapping[str, Any]) -> None: ...
    @property
    def lever_arm(self) -> ImuExtensionsDrawnLeverArm:
        """Positions of the accelerometers, nine. Takes a table with one of normal, uniform. Left out: as given."""
    @lever_arm.setter
    def lever_arm(self, value: ImuExtensionsDrawnLeverArm | Mapping[str, Any]) -> None: ...

class ImuExtensionsGyroGaussMarkov(Section):
    """First-order Gauss-Markov gyro bias. Takes a table with sigma, correlation_time. Left out: none."""

    correlation_time: str
    """Correlation time. Takes a time such as "12 h"."""
    sigma: str
    """Stationary standard deviation. Takes an angular rate such as "0.005 deg/h"."""

class ImuExtensionsLeverArm(Section):
    """Position of each accelerometer from the centre of rotation (size effect). Takes a table with x, y, z."""

    x: Sequence[str]
    """Of the x accelerometer. Takes an array of 3, each a length such as "0.15 m". Default: ["0 m", "0 m", "0
    m"]."""
    y: Sequence[str]
    """Of the y accelerometer. Takes an array of 3, each a length such as "0.15 m". Default: ["0 m", "0 m", "0
    m"]."""
    z: Sequence[str]
    """Of the z accelerometer. Takes an array of 3, each a length such as "0.15 m". Default: ["0 m", "0 m", "0
    m"]."""

class ImuExtensionsTemperature(Section):
    """A linear temperature ramp that ends at a plateau, and what it does. Takes a table with ramp, plateau,
    gyro_bias, accel_bias, gyro_scale, accel_scale. Left out: constant temperature."""

    accel_bias: Sequence[str]
    """Accelerometer bias per kelvin, x, y, z. Takes an array of 3, each an accelerometer bias sensitivity such
    as "2 ug/K". Default: ["0 ug/K", "0 ug/K", "0 ug/K"]."""
    accel_scale: Sequence[str]
    """Accelerometer scale factor per kelvin, x, y, z. Takes an array of 3, each a scale factor sensitivity such
    as "0.5 ppm/K". Default: ["0 ppm/K", "0 ppm/K", "0 ppm/K"]."""
    gyro_bias: Sequence[str]
    """Gyro bias per kelvin, x, y, z. Takes an array of 3, each a gyro bias sensitivity such as "0.0002 deg/h/K".
    Default: ["0 deg/h/K", "0 deg/h/K", "0 deg/h/K"]."""
    gyro_scale: Sequence[str]
    """Gyro scale factor per kelvin, x, y, z. Takes an array of 3, each a scale factor sensitivity such as "0.5
    ppm/K". Default: ["0 ppm/K", "0 ppm/K", "0 ppm/K"]."""
    plateau: str
    """Change at which the ramp ends, of the ramp's sign. Takes a temperature difference such as "20 K"."""
    ramp: str
    """Change per time, negative when cooling. Takes a temperature rate such as "5 K/h"."""

class ImuExtensionsVibration(Section):
    """Sinusoidal vibration of the sensor block, felt alike by gyros and accelerometers. Takes a table with
    frequency, displacement, angle, phase. Left out: none."""

    angle: Sequence[str]
    """Amplitude of the angular motion about body axes x, y, z. Takes an array of 3, each an angle such as "40
    arcsec". Default: ["0 arcsec", "0 arcsec", "0 arcsec"]."""
    displacement: Sequence[str]
    """Amplitude of the linear motion in body axes x, y, z. Takes an array of 3, each a length such as "0.15 m".
    Default: ["0 m", "0 m", "0 m"]."""
    frequency: str
    """Frequency. Takes a frequency such as "200 Hz"."""
    phase: str
    """Phase of the angular motion against the linear one. Takes an angle such as "30.5 deg". Default: "0 deg"."""

class ImuExtensions(Section):
    """What the sensors have and the filter doesn't model. Takes a table with gyro_gauss_markov,
    accel_gauss_markov, gyro_rate_random_walk, gyro_bias_instability, accel_bias_instability,
    gyro_quantization, accel_quantization, gyro_range, accel_range, temperature, vibration, lever_arm,
    gyro_asymmetry, accel_asymmetry, accel_quadratic, time_skew, drawn."""

    accel_asymmetry: Sequence[str]
    """Asymmetry of the accelerometers' scale factors a, x, y, z: a reading is too large by a |specific force|.
    Takes an array of 3, each a ratio such as "30 ppm". Default: ["0 ppm", "0 ppm", "0 ppm"]."""
    accel_bias_instability: str
    """Bias instability (1/f noise) of each accelerometer: coefficient B, the floor of the Allan deviation
    divided by 0.664. Takes an acceleration such as "100 ug". Default: "0 ug"."""
    @property
    def accel_gauss_markov(self) -> ImuExtensionsAccelGaussMarkov:
        """First-order Gauss-Markov accelerometer bias. Takes a table with sigma, correlation_time. Left out:
        none."""
    @accel_gauss_markov.setter
    def accel_gauss_markov(self, value: ImuExtensionsAccelGaussMarkov | Mapping[str, Any]) -> None: ...
    accel_quadratic: Sequence[str]
    """Second-order coefficients of the accelerometers (K2), x, y, z. Takes an array of 3, each a second-order
    coefficient such as "10 ug/g^2". Default: ["0 ug/g^2", "0 ug/g^2", "0 ug/g^2"]."""
    accel_quantization: str
    """Velocity of one accelerometer count, where coarser than the format's 1e-9 m/s; 0: none. Takes a velocity
    such as "1 mm/s". Default: "0 m/s"."""
    accel_range: str
    """Specific force at which the accelerometers saturate; 0: the format's own range. Takes an acceleration such
    as "9.81 m/s^2". Default: "40 g"."""
    @property
    def drawn(self) -> ImuExtensionsDrawn:
        """Errors that the seed draws, each group from its own stream; they add to the values given above. Takes
        a table with lever_arm, gyro_asymmetry, accel_asymmetry, accel_quadratic, gyro_bias_temperature,
        gyro_scale_temperature, accel_bias_temperature, accel_scale_temperature. Left out: nothing is drawn."""
    @drawn.setter
    def drawn(self, value: ImuExtensionsDrawn | Mapping[str, Any]) -> None: ...
    gyro_asymmetry: Sequence[str]
    """Asymmetry of the gyros' scale factors a, x, y, z: a reading is too large by a |rate|. Takes an array of 3,
    each a ratio such as "30 ppm". Default: ["0 ppm", "0 ppm", "0 ppm"]."""
    gyro_bias_instability: str
    """Bias instability (1/f noise) of each gyro: coefficient B of IEEE Std 952, the floor of the Allan deviation
    divided by 0.664. Takes an angular rate such as "0.005 deg/h". Default: "0 deg/h"."""
    @property
    def gyro_gauss_markov(self) -> ImuExtensionsGyroGaussMarkov:
        """First-order Gauss-Markov gyro bias. Takes a table with sigma, correlation_time. Left out: none."""
    @gyro_gauss_markov.setter
    def gyro_gauss_markov(self, value: ImuExtensionsGyroGaussMarkov | Mapping[str, Any]) -> None: ...
    gyro_quantization: str
    """Angle of one gyro count, where coarser than the format's 3e-6 arcsec; 0: none. Takes an angle such as "40
    arcsec". Default: "0 arcsec"."""
    gyro_range: str
    """Rate at which the gyros saturate; 0: the format's own range. Takes an angular rate such as "10 deg/s".
    Default: "300 deg/s"."""
    gyro_rate_random_walk: str
    """Rate random walk of each gyro. Takes a rate random walk such as "0.0001 deg/h/sqrt(h)". Default: "0
    deg/h/sqrt(h)"."""
    @property
    def lever_arm(self) -> ImuExtensionsLeverArm:
        """Position of each accelerometer from the centre of rotation (size effect). Takes a table with x, y, z."""
    @lever_arm.setter
    def lever_arm(self, value: ImuExtensionsLeverArm | Mapping[str, Any]) -> None: ...
    @property
    def temperature(self) -> ImuExtensionsTemperature:
        """A linear temperature ramp that ends at a plateau, and what it does. Takes a table with ramp, plateau,
        gyro_bias, accel_bias, gyro_scale, accel_scale. Left out: constant temperature."""
    @temperature.setter
    def temperature(self, value: ImuExtensionsTemperature | Mapping[str, Any]) -> None: ...
    time_skew: str
    """Stamp minus true time of validity of the inertial data, against the gimbal angles. Takes a time such as
    "12 h". Default: "0 s"."""
    @property
    def vibration(self) -> ImuExtensionsVibration:
        """Sinusoidal vibration of the sensor block, felt alike by gyros and accelerometers. Takes a table with
        frequency, displacement, angle, phase. Left out: none."""
    @vibration.setter
    def vibration(self, value: ImuExtensionsVibration | Mapping[str, Any]) -> None: ...

class ImuGDependent(Section):
    """g-dependent gyro biases, a full matrix. Takes a table with one of normal, uniform, constant. Default:
    {"normal": "0.0005 deg/h/g"}."""

    constant: Sequence[str]
    """The values themselves: by rows xx, xy, xz, yx, yy, yz, zx, zy, zz. Takes an array of 9, each a g-dependent
    gyro bias such as "0.0005 deg/h/g". Left out: another is given."""
    normal: str
    """Drawn from a normal distribution of this standard deviation, each entry alone. Takes a g-dependent gyro
    bias such as "0.0005 deg/h/g". Left out: another is given."""
    uniform: str
    """Drawn evenly within plus and minus this half width, each entry alone. Takes a g-dependent gyro bias such
    as "0.0005 deg/h/g". Left out: another is given."""

class ImuGyroBias(Section):
    """Constant gyro biases. Takes a table with one of normal, uniform, constant. Default: {"normal": "0.005
    deg/h"}."""

    constant: Sequence[str]
    """The values themselves: x, y, z. Takes an array of 3, each an angular rate such as "0.005 deg/h". Left out:
    another is given."""
    normal: str
    """Drawn from a normal distribution of this standard deviation, each entry alone. Takes an angular rate such
    as "0.005 deg/h". Left out: another is given."""
    uniform: str
    """Drawn evenly within plus and minus this half width, each entry alone. Takes an angular rate such as "0.005
    deg/h". Left out: another is given."""

class ImuGyroMisalignment(Section):
    """Gyro misalignments. Takes a table with one of normal, uniform, constant. Default: {"uniform": "40
    arcsec"}."""

    constant: Sequence[str]
    """The values themselves: xy, xz, yx, yz, zx, zy. Takes an array of 6, each an angle such as "40 arcsec".
    Left out: another is given."""
    normal: str
    """Drawn from a normal distribution of this standard deviation, each entry alone. Takes an angle such as "40
    arcsec". Left out: another is given."""
    uniform: str
    """Drawn evenly within plus and minus this half width, each entry alone. Takes an angle such as "40 arcsec".
    Left out: another is given."""

class ImuGyroScale(Section):
    """Gyro scale factor errors. Takes a table with one of normal, uniform, constant. Default: {"uniform": "30
    ppm"}."""

    constant: Sequence[str]
    """The values themselves: x, y, z. Takes an array of 3, each a ratio such as "30 ppm". Left out: another is
    given."""
    normal: str
    """Drawn from a normal distribution of this standard deviation, each entry alone. Takes a ratio such as "30
    ppm". Left out: another is given."""
    uniform: str
    """Drawn evenly within plus and minus this half width, each entry alone. Takes a ratio such as "30 ppm". Left
    out: another is given."""

class Imu(Section):
    """The sensors and their true errors. Takes a table with model, rate, angle_random_walk,
    velocity_random_walk, gyro_bias, gyro_scale, gyro_misalignment, g_dependent, accel_bias, accel_scale,
    accel_misalignment, extensions."""

    @property
    def accel_bias(self) -> ImuAccelBias:
        """Constant accelerometer biases. Takes a table with one of normal, uniform, constant. Default:
        {"normal": "100 ug"}."""
    @accel_bias.setter
    def accel_bias(self, value: ImuAccelBias | Mapping[str, Any]) -> None: ...
    @property
    def accel_misalignment(self) -> ImuAccelMisalignment:
        """Accelerometer misalignments; the accelerometers define the body frame. Takes a table with one of
        normal, uniform, constant. Default: {"uniform": "40 arcsec"}."""
    @accel_misalignment.setter
    def accel_misalignment(self, value: ImuAccelMisalignment | Mapping[str, Any]) -> None: ...
    @property
    def accel_scale(self) -> ImuAccelScale:
        """Accelerometer scale factor errors. Takes a table with one of normal, uniform, constant. Default:
        {"uniform": "30 ppm"}."""
    @accel_scale.setter
    def accel_scale(self, value: ImuAccelScale | Mapping[str, Any]) -> None: ...
    angle_random_walk: str
    """Angle random walk of each gyro. Takes an angle random walk such as "0.0007 deg/sqrt(h)". Default: "0.0007
    deg/sqrt(h)"."""
    @property
    def extensions(self) -> ImuExtensions:
        """What the sensors have and the filter doesn't model. Takes a table with gyro_gauss_markov,
        accel_gauss_markov, gyro_rate_random_walk, gyro_bias_instability, accel_bias_instability,
        gyro_quantization, accel_quantization, gyro_range, accel_range, temperature, vibration, lever_arm,
        gyro_asymmetry, accel_asymmetry, accel_quadratic, time_skew, drawn."""
    @extensions.setter
    def extensions(self, value: ImuExtensions | Mapping[str, Any]) -> None: ...
    @property
    def g_dependent(self) -> ImuGDependent:
        """g-dependent gyro biases, a full matrix. Takes a table with one of normal, uniform, constant. Default:
        {"normal": "0.0005 deg/h/g"}."""
    @g_dependent.setter
    def g_dependent(self, value: ImuGDependent | Mapping[str, Any]) -> None: ...
    @property
    def gyro_bias(self) -> ImuGyroBias:
        """Constant gyro biases. Takes a table with one of normal, uniform, constant. Default: {"normal": "0.005
        deg/h"}."""
    @gyro_bias.setter
    def gyro_bias(self, value: ImuGyroBias | Mapping[str, Any]) -> None: ...
    @property
    def gyro_misalignment(self) -> ImuGyroMisalignment:
        """Gyro misalignments. Takes a table with one of normal, uniform, constant. Default: {"uniform": "40
        arcsec"}."""
    @gyro_misalignment.setter
    def gyro_misalignment(self, value: ImuGyroMisalignment | Mapping[str, Any]) -> None: ...
    @property
    def gyro_scale(self) -> ImuGyroScale:
        """Gyro scale factor errors. Takes a table with one of normal, uniform, constant. Default: {"uniform":
        "30 ppm"}."""
    @gyro_scale.setter
    def gyro_scale(self, value: ImuGyroScale | Mapping[str, Any]) -> None: ...
    model: Literal["table-1", "navigation-laser", "navigation-fibre-optic", "tactical-fibre-optic", "tactical-mems"]
    """Instrument whose values stand where no others are given, here and in procedure.calibration.prior. Takes
    one of "table-1", "navigation-laser", "navigation-fibre-optic", "tactical-fibre-optic", "tactical-mems".
    Default: "table-1"."""
    rate: str
    """Samples per second; the period is a whole number of nanoseconds. Takes a frequency such as "200 Hz".
    Default: "200 Hz"."""
    velocity_random_walk: str
    """Noise density of each accelerometer. Takes an accelerometer noise density such as "50 ug/sqrt(Hz)".
    Default: "50 ug/sqrt(Hz)"."""

class MotionShipSpectrum(Section):
    """Irregular sea: sinusoids of a Pierson-Moskowitz spectrum are added, with frequencies and phases drawn from
    the seed. Takes a table with peak_period, components, roll, pitch, yaw, surge, sway, heave. Left out:
    sinusoids alone."""

    components: int
    """Sinusoids of each motion, spread over frequency. Takes a whole number from 2 to 64. Default: 16."""
    heave: str
    """Root mean square of heave. Takes a length such as "0.15 m". Default: "0 m"."""
    peak_period: str
    """Period at which the spectrum has its peak. Takes a time such as "12 h"."""
    pitch: str
    """Root mean square of pitch. Takes an angle such as "30.5 deg". Default: "0 deg"."""
    roll: str
    """Root mean square of roll. Takes an angle such as "30.5 deg". Default: "0 deg"."""
    surge: str
    """Root mean square of surge. Takes a length such as "0.15 m". Default: "0 m"."""
    sway: str
    """Root mean square of sway. Takes a length such as "0.15 m". Default: "0 m"."""
    yaw: str
    """Root mean square of yaw. Takes an angle such as "30.5 deg". Default: "0 deg"."""

class MotionShip(Section):
    """Motion of the moored ship about the mean attitude and position. Takes a table with preset, roll, pitch,
    yaw, surge, sway, heave, spectrum, mooring_offset, from, duration, ramp. Default: dockside: the default
    sway; static: none."""

    duration: str
    """How long it has its full amplitude; after it the case returns to rest. Takes a time such as "12 h". Left
    out: to the end."""
    from: str
    """When the motion begins, since the unit was switched on: before it the case is at rest. Takes a time such
    as "12 h". Left out: from the start, without a ramp."""
    heave: Sequence[Mapping[str, Any]]
    """Vertical motion, positive down. Takes an array of tables with amplitude, period, phase. Left out: as in
    the preset."""
    mooring_offset: Sequence[str]
    """Constant offset from the dock's reference position: north, east, down. Takes an array of 3, each a length
    such as "0.15 m". Default: ["0 m", "0 m", "0 m"]."""
    pitch: Sequence[Mapping[str, Any]]
    """Pitch of the ship. Takes an array of tables with amplitude, period, phase. Left out: as in the preset."""
    preset: Literal["default", "severe", "scorsby", "scorsby-settling", "calm"]
    """Ready-made motion; components that are given replace those of the preset. Takes one of "default",
    "severe", "scorsby", "scorsby-settling", "calm". Default: "default", or "calm" when components or a
    spectrum are given."""
    ramp: str
    """How long it grows, before that time, and dies away, after it; with from or duration. Takes a time such as
    "12 h". Default: "10 s"."""
    roll: Sequence[Mapping[str, Any]]
    """Roll of the ship: a sum of sinusoids. Takes an array of tables with amplitude, period, phase. Left out: as
    in the preset."""
    @property
    def spectrum(self) -> MotionShipSpectrum:
        """Irregular sea: sinusoids of a Pierson-Moskowitz spectrum are added, with frequencies and phases drawn
        from the seed. Takes a table with peak_period, components, roll, pitch, yaw, surge, sway, heave. Left
        out: sinusoids alone."""
    @spectrum.setter
    def spectrum(self, value: MotionShipSpectrum | Mapping[str, Any]) -> None: ...
    surge: Sequence[Mapping[str, Any]]
    """Motion along the mean heading. Takes an array of tables with amplitude, period, phase. Left out: as in the
    preset."""
    sway: Sequence[Mapping[str, Any]]
    """Motion to starboard of the mean heading. Takes an array of tables with amplitude, period, phase. Left out:
    as in the preset."""
    yaw: Sequence[Mapping[str, Any]]
    """Yaw of the ship. Takes an array of tables with amplitude, period, phase. Left out: as in the preset."""

class Motion(Section):
    """How the case of the instrument moves. Takes a table with kind, heading, pitch, roll, ship."""

    heading: str
    """Mean heading of the case, from north over east. Takes an angle such as "30.5 deg". Default: "0 deg"."""
    kind: Literal["static", "dockside"]
    """Whether the case stands still. Takes one of "static", "dockside". Default: "static"."""
    pitch: str
    """Mean pitch of the case, bow up positive. Takes an angle such as "30.5 deg". Default: "0 deg"."""
    roll: str
    """Mean roll of the case, starboard down positive. Takes an angle such as "30.5 deg". Default: "0 deg"."""
    @property
    def ship(self) -> MotionShip:
        """Motion of the moored ship about the mean attitude and position. Takes a table with preset, roll,
        pitch, yaw, surge, sway, heave, spectrum, mooring_offset, from, duration, ramp. Default: dockside: the
        default sway; static: none."""
    @ship.setter
    def ship(self, value: MotionShip | Mapping[str, Any]) -> None: ...

class Power(Section):
    """The supply or the relay that feeds the device of the endpoint, over SCPI. Takes a table with port,
    channel, relay, voltage, current_limit, tolerance, settle, rest, lead, reply, remote, end. Left out:
    nothing is switched."""

    channel: int
    """Channel of the supply, selected by its number. Takes a whole number from 1 to 999. Left out: the supply
    has one channel, or the selected one is meant."""
    current_limit: str
    """Current limit of the supply. Takes a current such as "2 A". Left out: a relay has none."""
    end: Literal["off", "on"]
    """How the output is left when the run has ended, however it ended. Takes one of "off", "on". Default: "off"."""
    lead: str
    """How long the device is on before it is greeted and the run begins. Takes a time such as "12 h". Default:
    "0 s"."""
    port: str
    """Port of the supply or of the relays, which speak SCPI: tcp:HOST or tcp:HOST:PORT (5025 by default), or
    serial:DEVICE?baud=RATE (9600 by default). Takes a text in quotes."""
    relay: int
    """Number of the relay that feeds the device, in place of a channel: closed is on. Takes a whole number from
    1 to 999999999. Left out: a supply feeds the device."""
    remote: bool
    """Whether SYST:REM is sent first: some supplies need it on a serial line. Takes true or false. Default:
    false."""
    reply: str
    """How long a reply of the instrument is waited for. Takes a time such as "12 h". Default: "2 s"."""
    rest: str
    """How long the output is off before it is switched on for the run. 0 s: a device that is on stays on. Takes
    a time such as "12 h". Default: "1 s"."""
    settle: str
    """How long a measured voltage may take to come to its value; then the run ends as an error of the bench.
    Takes a time such as "12 h". Default: "2 s"."""
    tolerance: str
    """Largest deviation of a measured voltage, as a share of the voltage; also the largest voltage that is off.
    Takes a ratio such as "30 ppm". Default: "5 %"."""
    voltage: str
    """Voltage of the supply. Takes a voltage such as "24 V". Left out: a relay has none."""

class ProcedureAlignment(Section):
    """How the initial attitude is found. Takes a table with method, tilt, azimuth, velocity, attitude_error,
    velocity_error, duration."""

    attitude_error: Sequence[str]
    """The attitude error itself, north, east, down: computed = (I − [φ×]) true. Takes an array of 3, each an
    angle such as "40 arcsec". Left out: drawn from tilt and azimuth."""
    azimuth: str
    """Error of the azimuth handed over, one standard deviation. Takes an angle such as "30.5 deg". Default: "0.1
    deg"."""
    duration: str
    """Coarse and inertial alignment: how long. 300 s and more in the inertial frame, on a ship 600 s. Takes a
    time such as "12 h". Default: "60 s"."""
    method: Literal["given", "coarse", "inertial"]
    """How the initial attitude is found. Takes one of "given", "coarse", "inertial". Default: "given"."""
    tilt: str
    """Error of the tilt handed over, one standard deviation, about north and east. Takes an angle such as "40
    arcsec". Default: "60 arcsec"."""
    velocity: str
    """Error of each velocity handed over, one standard deviation. Takes a velocity such as "1 mm/s". Default:
    "0.02 m/s"."""
    velocity_error: Sequence[str]
    """The velocity error itself, north, east, down. Takes an array of 3, each a velocity such as "1 mm/s". Left
    out: drawn from velocity."""

class ProcedureCalibrationAiding(Section):
    """The reference that the filter measures against. Takes a table with reference, period, sway, sigma, noise."""

    noise: str
    """Standard deviation of the white noise that the reference really has. Takes a velocity such as "1 mm/s" or
    a length such as "0.15 m". Default: velocities: "1 mm/s"; dock-position: "0.01 m"."""
    period: str
    """Time between measurements: a multiple of the sample period. Takes a time such as "12 h". Default: "1 s"."""
    reference: Literal["zero-velocity", "velocity", "dock-position"]
    """What is measured. Takes one of "zero-velocity", "velocity", "dock-position". Default: static: "zero-
    velocity"; dockside: "dock-position"."""
    sigma: str
    """Standard deviation of each axis, as the filter believes it. Takes a velocity such as "1 mm/s" or a length
    such as "0.15 m". Default: velocities: "1 mm/s"; dock-position: "0.15 m"; with sway = "coloured": "0.01
    m"."""
    sway: Literal["white", "coloured"]
    """What the sway of the ship is to the filter. Takes one of "white", "coloured". Default: "white"."""

class ProcedureCalibrationFurtherAccelAsymmetry(Section):
    """The same of the accelerometers, three. Takes a table with one of estimated, considered. Left out: off."""

    considered: str
    """Their uncertainty of this standard deviation counts, and they are never moved (Schmidt). Takes a ratio
    such as "30 ppm". Left out: another is given."""
    estimated: str
    """The filter estimates and compensates them, from this standard deviation. Takes a ratio such as "30 ppm".
    Left out: another is given."""

class ProcedureCalibrationFurtherAccelBiasTemperature(Section):
    """Temperature coefficients of the accelerometer biases, three. Takes a table with one of estimated,
    considered. Left out: off."""

    considered: str
    """Their uncertainty of this standard deviation counts, and they are never moved (Schmidt). Takes an
    accelerometer bias sensitivity such as "2 ug/K". Left out: another is given."""
    estimated: str
    """The filter estimates and compensates them, from this standard deviation. Takes an accelerometer bias
    sensitivity such as "2 ug/K". Left out: another is given."""

class ProcedureCalibrationFurtherAccelGaussMarkov(Section):
    """First-order Gauss-Markov biases of the accelerometers, three. Takes a table with one of estimated,
    considered. Left out: off."""

    considered: str
    """Their uncertainty of this standard deviation counts, and they are never moved (Schmidt). Takes an
    acceleration such as "100 ug". Left out: another is given."""
    estimated: str
    """The filter estimates and compensates them, from this standard deviation. Takes an acceleration such as
    "100 ug". Left out: another is given."""

class ProcedureCalibrationFurtherAccelLever(Section):
    """Positions of the accelerometers' proof masses from the centre of rotation (size effect), nine. Takes a
    table with one of estimated, considered. Left out: off."""

    considered: str
    """Their uncertainty of this standard deviation counts, and they are never moved (Schmidt). Takes a length
    such as "0.15 m". Left out: another is given."""
    estimated: str
    """The filter estimates and compensates them, from this standard deviation. Takes a length such as "0.15 m".
    Left out: another is given."""

class ProcedureCalibrationFurtherAccelQuadratic(Section):
    """Second-order coefficients of the accelerometers (K2), three. Takes a table with one of estimated,
    considered. Left out: off."""

    considered: str
    """Their uncertainty of this standard deviation counts, and they are never moved (Schmidt). Takes a second-
    order coefficient such as "10 ug/g^2". Left out: another is given."""
    estimated: str
    """The filter estimates and compensates them, from this standard deviation. Takes a second-order coefficient
    such as "10 ug/g^2". Left out: another is given."""

class ProcedureCalibrationFurtherAccelScaleTemperature(Section):
    """Temperature coefficients of the accelerometers' scale factors, three. Takes a table with one of estimated,
    considered. Left out: off."""

    considered: str
    """Their uncertainty of this standard deviation counts, and they are never moved (Schmidt). Takes a scale
    factor sensitivity such as "0.5 ppm/K". Left out: another is given."""
    estimated: str
    """The filter estimates and compensates them, from this standard deviation. Takes a scale factor sensitivity
    such as "0.5 ppm/K". Left out: another is given."""

class ProcedureCalibrationFurtherDeflection(Section):
    """Deflection of the vertical, north and east. On a base at rest it can't be told from a tilt: to be
    considered. Takes a table with one of estimated, considered. Left out: off."""

    considered: str
    """Their uncertainty of this standard deviation counts, and they are never moved (Schmidt). Takes an angle
    such as "40 arcsec". Left out: another is given."""
    estimated: str
    """The filter estimates and compensates them, from this standard deviation. Takes an angle such as "40
    arcsec". Left out: another is given."""

class ProcedureCalibrationFurtherGimbalAnglesEccentricity(Section):
    """Eccentricity of the encoders: cosine and sine of azimuth and of roll, four. Takes a table with one of
    estimated, considered. Left out: off."""

    considered: str
    """Their uncertainty of this standard deviation counts, and they are never moved (Schmidt). Takes an angle
    such as "40 arcsec". Left out: another is given."""
    estimated: str
    """The filter estimates and compensates them, from this standard deviation. Takes an angle such as "40
    arcsec". Left out: another is given."""

class ProcedureCalibrationFurtherGimbalAnglesMounting(Section):
    """Mounting of the body on the inner gimbal, three. z stands for the zero error of the azimuth encoder too.
    Takes a table with one of estimated, considered. Left out: off."""

    considered: str
    """Their uncertainty of this standard deviation counts, and they are never moved (Schmidt). Takes an angle
    such as "40 arcsec". Left out: another is given."""
    estimated: str
    """The filter estimates and compensates them, from this standard deviation. Takes an angle such as "40
    arcsec". Left out: another is given."""

class ProcedureCalibrationFurtherGimbalAnglesNonOrthogonality(Section):
    """Angle by which the gimbal axes miss a right angle, one. Takes a table with one of estimated, considered.
    Left out: off."""

    considered: str
    """Their uncertainty of this standard deviation counts, and they are never moved (Schmidt). Takes an angle
    such as "40 arcsec". Left out: another is given."""
    estimated: str
    """The filter estimates and compensates them, from this standard deviation. Takes an angle such as "40
    arcsec". Left out: another is given."""

class ProcedureCalibrationFurtherGimbalAngles(Section):
    """Gimbal angles as measurements of attitude, once per aiding period while the gimbals rest. For a case at
    rest. Takes a table with sigma, curve, mounting, non_orthogonality, eccentricity. Left out: the angles
    tell the filter nothing."""

    curve: str
    """Rest of an encoder's error curve beyond its eccentricity, one standard deviation: a constant of each stop,
    another one after each move. Takes an angle such as "40 arcsec". Default: "0 arcsec"."""
    @property
    def eccentricity(self) -> ProcedureCalibrationFurtherGimbalAnglesEccentricity:
        """Eccentricity of the encoders: cosine and sine of azimuth and of roll, four. Takes a table with one of
        estimated, considered. Left out: off."""
    @eccentricity.setter
    def eccentricity(self, value: ProcedureCalibrationFurtherGimbalAnglesEccentricity | Mapping[str, Any]) -> None: ...
    @property
    def mounting(self) -> ProcedureCalibrationFurtherGimbalAnglesMounting:
        """Mounting of the body on the inner gimbal, three. z stands for the zero error of the azimuth encoder
        too. Takes a table with one of estimated, considered. Left out: off."""
    @mounting.setter
    def mounting(self, value: ProcedureCalibrationFurtherGimbalAnglesMounting | Mapping[str, Any]) -> None: ...
    @property
    def non_orthogonality(self) -> ProcedureCalibrationFurtherGimbalAnglesNonOrthogonality:
        """Angle by which the gimbal axes miss a right angle, one. Takes a table with one of estimated,
        considered. Left out: off."""
    @non_orthogonality.setter
    def non_orthogonality(self, value: ProcedureCalibrationFurtherGimbalAnglesNonOrthogonality | Mapping[str, Any]) -> None: ...
    sigma: str
    """White noise of a reading, one standard deviation: encoders and wobble of the gimbals. Takes an angle such
    as "40 arcsec". Default: "1 arcsec"."""

class ProcedureCalibrationFurtherGravityAnomaly(Section):
    """True minus normal gravity. On a base at rest it can't be told from a common scale factor of the
    accelerometers: to be considered. Takes a table with one of estimated, considered. Left out: off."""

    considered: str
    """Their uncertainty of this standard deviation counts, and they are never moved (Schmidt). Takes an
    acceleration such as "100 ug". Left out: another is given."""
    estimated: str
    """The filter estimates and compensates them, from this standard deviation. Takes an acceleration such as
    "100 ug". Left out: another is given."""

class ProcedureCalibrationFurtherGyroAsymmetry(Section):
    """Difference of the gyros' scale factors by the sign of the rate, of which this is half, three. Takes a
    table with one of estimated, considered. Left out: off."""

    considered: str
    """Their uncertainty of this standard deviation counts, and they are never moved (Schmidt). Takes a ratio
    such as "30 ppm". Left out: another is given."""
    estimated: str
    """The filter estimates and compensates them, from this standard deviation. Takes a ratio such as "30 ppm".
    Left out: another is given."""

class ProcedureCalibrationFurtherGyroBiasTemperature(Section):
    """Temperature coefficients of the gyro biases, three. Takes a table with one of estimated, considered. Left
    out: off."""

    considered: str
    """Their uncertainty of this standard deviation counts, and they are never moved (Schmidt). Takes a gyro bias
    sensitivity such as "0.0002 deg/h/K". Left out: another is given."""
    estimated: str
    """The filter estimates and compensates them, from this standard deviation. Takes a gyro bias sensitivity
    such as "0.0002 deg/h/K". Left out: another is given."""

class ProcedureCalibrationFurtherGyroGaussMarkov(Section):
    """First-order Gauss-Markov biases of the gyros, three. Takes a table with one of estimated, considered. Left
    out: off."""

    considered: str
    """Their uncertainty of this standard deviation counts, and they are never moved (Schmidt). Takes an angular
    rate such as "0.005 deg/h". Left out: another is given."""
    estimated: str
    """The filter estimates and compensates them, from this standard deviation. Takes an angular rate such as
    "0.005 deg/h". Left out: another is given."""

class ProcedureCalibrationFurtherGyroScaleTemperature(Section):
    """Temperature coefficients of the gyros' scale factors, three. Takes a table with one of estimated,
    considered. Left out: off."""

    considered: str
    """Their uncertainty of this standard deviation counts, and they are never moved (Schmidt). Takes a scale
    factor sensitivity such as "0.5 ppm/K". Left out: another is given."""
    estimated: str
    """The filter estimates and compensates them, from this standard deviation. Takes a scale factor sensitivity
    such as "0.5 ppm/K". Left out: another is given."""

class ProcedureCalibrationFurther(Section):
    """Errors beside the thirty parameters that the filter considers or estimates. Takes a table with
    accel_lever, gyro_asymmetry, accel_asymmetry, accel_quadratic, gyro_gauss_markov, gyro_correlation_time,
    accel_gauss_markov, accel_correlation_time, gyro_rate_random_walk, deflection, gravity_anomaly,
    gyro_bias_temperature, gyro_scale_temperature, accel_bias_temperature, accel_scale_temperature,
    temperature_reference_c, gimbal_angles. Left out: none."""

    @property
    def accel_asymmetry(self) -> ProcedureCalibrationFurtherAccelAsymmetry:
        """The same of the accelerometers, three. Takes a table with one of estimated, considered. Left out: off."""
    @accel_asymmetry.setter
    def accel_asymmetry(self, value: ProcedureCalibrationFurtherAccelAsymmetry | Mapping[str, Any]) -> None: ...
    @property
    def accel_bias_temperature(self) -> ProcedureCalibrationFurtherAccelBiasTemperature:
        """Temperature coefficients of the accelerometer biases, three. Takes a table with one of estimated,
        considered. Left out: off."""
    @accel_bias_temperature.setter
    def accel_bias_temperature(self, value: ProcedureCalibrationFurtherAccelBiasTemperature | Mapping[str, Any]) -> None: ...
    accel_correlation_time: str
    """Correlation time of accel_gauss_markov. Takes a time such as "12 h". Default: "1 h"."""
    @property
    def accel_gauss_markov(self) -> ProcedureCalibrationFurtherAccelGaussMarkov:
        """First-order Gauss-Markov biases of the accelerometers, three. Takes a table with one of estimated,
        considered. Left out: off."""
    @accel_gauss_markov.setter
    def accel_gauss_markov(self, value: ProcedureCalibrationFurtherAccelGaussMarkov | Mapping[str, Any]) -> None: ...
    @property
    def accel_lever(self) -> ProcedureCalibrationFurtherAccelLever:
        """Positions of the accelerometers' proof masses from the centre of rotation (size effect), nine. Takes a
        table with one of estimated, considered. Left out: off."""
    @accel_lever.setter
    def accel_lever(self, value: ProcedureCalibrationFurtherAccelLever | Mapping[str, Any]) -> None: ...
    @property
    def accel_quadratic(self) -> ProcedureCalibrationFurtherAccelQuadratic:
        """Second-order coefficients of the accelerometers (K2), three. Takes a table with one of estimated,
        considered. Left out: off."""
    @accel_quadratic.setter
    def accel_quadratic(self, value: ProcedureCalibrationFurtherAccelQuadratic | Mapping[str, Any]) -> None: ...
    @property
    def accel_scale_temperature(self) -> ProcedureCalibrationFurtherAccelScaleTemperature:
        """Temperature coefficients of the accelerometers' scale factors, three. Takes a table with one of
        estimated, considered. Left out: off."""
    @accel_scale_temperature.setter
    def accel_scale_temperature(self, value: ProcedureCalibrationFurtherAccelScaleTemperature | Mapping[str, Any]) -> None: ...
    @property
    def deflection(self) -> ProcedureCalibrationFurtherDeflection:
        """Deflection of the vertical, north and east. On a base at rest it can't be told from a tilt: to be
        considered. Takes a table with one of estimated, considered. Left out: off."""
    @deflection.setter
    def deflection(self, value: ProcedureCalibrationFurtherDeflection | Mapping[str, Any]) -> None: ...
    @property
    def gimbal_angles(self) -> ProcedureCalibrationFurtherGimbalAngles:
        """Gimbal angles as measurements of attitude, once per aiding period while the gimbals rest. For a case
        at rest. Takes a table with sigma, curve, mounting, non_orthogonality, eccentricity. Left out: the
        angles tell the filter nothing."""
    @gimbal_angles.setter
    def gimbal_angles(self, value: ProcedureCalibrationFurtherGimbalAngles | Mapping[str, Any]) -> None: ...
    @property
    def gravity_anomaly(self) -> ProcedureCalibrationFurtherGravityAnomaly:
        """True minus normal gravity. On a base at rest it can't be told from a common scale factor of the
        accelerometers: to be considered. Takes a table with one of estimated, considered. Left out: off."""
    @gravity_anomaly.setter
    def gravity_anomaly(self, value: ProcedureCalibrationFurtherGravityAnomaly | Mapping[str, Any]) -> None: ...
    @property
    def gyro_asymmetry(self) -> ProcedureCalibrationFurtherGyroAsymmetry:
        """Difference of the gyros' scale factors by the sign of the rate, of which this is half, three. Takes a
        table with one of estimated, considered. Left out: off."""
    @gyro_asymmetry.setter
    def gyro_asymmetry(self, value: ProcedureCalibrationFurtherGyroAsymmetry | Mapping[str, Any]) -> None: ...
    @property
    def gyro_bias_temperature(self) -> ProcedureCalibrationFurtherGyroBiasTemperature:
        """Temperature coefficients of the gyro biases, three. Takes a table with one of estimated, considered.
        Left out: off."""
    @gyro_bias_temperature.setter
    def gyro_bias_temperature(self, value: ProcedureCalibrationFurtherGyroBiasTemperature | Mapping[str, Any]) -> None: ...
    gyro_correlation_time: str
    """Correlation time of gyro_gauss_markov. Takes a time such as "12 h". Default: "1 h"."""
    @property
    def gyro_gauss_markov(self) -> ProcedureCalibrationFurtherGyroGaussMarkov:
        """First-order Gauss-Markov biases of the gyros, three. Takes a table with one of estimated, considered.
        Left out: off."""
    @gyro_gauss_markov.setter
    def gyro_gauss_markov(self, value: ProcedureCalibrationFurtherGyroGaussMarkov | Mapping[str, Any]) -> None: ...
    gyro_rate_random_walk: str
    """Rate random walk of the gyros: process noise of their biases. With it the biases are no constants, and the
    drift test is off. Takes a rate random walk such as "0.0001 deg/h/sqrt(h)". Default: "0 deg/h/sqrt(h)"."""
    @property
    def gyro_scale_temperature(self) -> ProcedureCalibrationFurtherGyroScaleTemperature:
        """Temperature coefficients of the gyros' scale factors, three. Takes a table with one of estimated,
        considered. Left out: off."""
    @gyro_scale_temperature.setter
    def gyro_scale_temperature(self, value: ProcedureCalibrationFurtherGyroScaleTemperature | Mapping[str, Any]) -> None: ...
    temperature_reference_c: float
    """Temperature of the instrument at which its parameters are as they are estimated, degC. Takes a number that
    is finite. Left out: the first temperature."""

class ProcedureCalibrationLeastSquares(Section):
    """Settings of the least-squares estimator. Takes a table with gravity, gyro, intervals, initial, window,
    threshold, shortest."""

    gravity: str
    """Local gravity. Takes an acceleration such as "9.81 m/s^2". Left out: normal gravity at the site."""
    gyro: Literal["earth-rate", "rotated-gravity"]
    """What the gyros are measured against. Takes one of "earth-rate", "rotated-gravity". Default: "earth-rate"."""
    initial: str
    """Detected: length of the first interval, known to be static. Takes a time such as "12 h". Default: "50 s"."""
    intervals: Literal["commanded", "detected"]
    """How static intervals are found. Takes one of "commanded", "detected". Default: "commanded"."""
    shortest: str
    """Detected: shortest interval to use. Takes a time such as "12 h". Default: "2 s"."""
    threshold: float
    """Detected: multiple of the first interval's standard deviation. Takes a number above 0. Default: 5.0."""
    window: str
    """Detected: window of the standard deviation. Takes a time such as "12 h". Default: "1 s"."""

class ProcedureCalibrationPrior(Section):
    """Standard deviations that the filter starts from. Takes a table with attitude, velocity, position,
    gyro_bias, gyro_scale, gyro_misalignment, g_dependent, accel_bias, accel_scale, accel_misalignment."""

    accel_bias: str
    """Accelerometer biases. Takes an acceleration such as "100 ug". Default: "100 ug"."""
    accel_misalignment: str
    """Accelerometer misalignments. Takes an angle such as "40 arcsec". Default: "40 arcsec"."""
    accel_scale: str
    """Accelerometer scale factors. Takes a ratio such as "30 ppm". Default: "30 ppm"."""
    attitude: Sequence[str]
    """Attitude error north, east, down. Takes an array of 3, each an angle such as "40 arcsec". Default: ["60
    arcsec", "60 arcsec", "0.1 deg"]."""
    g_dependent: str
    """g-dependent gyro biases. Takes a g-dependent gyro bias such as "0.0005 deg/h/g". Default: where
    imu.g_dependent is drawn: its standard deviation; elsewhere: "0.0005 deg/h/g"."""
    gyro_bias: str
    """Gyro biases. Takes an angular rate such as "0.005 deg/h". Default: "0.005 deg/h"."""
    gyro_misalignment: str
    """Gyro misalignments. Takes an angle such as "40 arcsec". Default: "40 arcsec"."""
    gyro_scale: str
    """Gyro scale factors. Takes a ratio such as "30 ppm". Default: "30 ppm"."""
    position: str
    """Position, each axis. Takes a length such as "0.15 m". Default: simulated at rest: "1 cm"; elsewhere: "1
    m"."""
    velocity: str
    """Velocity, each axis. Takes a velocity such as "1 mm/s". Default: "0.02 m/s"."""

class ProcedureCalibrationRefuseAboveSigma(Section):
    """Largest standard deviations at the end of a calibration that is published. Takes a table with heading,
    tilt, gyro_bias, gyro_scale, gyro_misalignment, g_dependent, accel_bias, accel_scale, accel_misalignment."""

    accel_bias: str
    """Each accelerometer bias. Takes an acceleration such as "100 ug". Left out: no limit."""
    accel_misalignment: str
    """Each accelerometer misalignment. Takes an angle such as "40 arcsec". Left out: no limit."""
    accel_scale: str
    """Each accelerometer scale factor. Takes a ratio such as "30 ppm". Left out: no limit."""
    g_dependent: str
    """Each g-dependent gyro bias. Takes a g-dependent gyro bias such as "0.0005 deg/h/g". Left out: no limit."""
    gyro_bias: str
    """Each gyro bias. Takes an angular rate such as "0.005 deg/h". Left out: no limit."""
    gyro_misalignment: str
    """Each gyro misalignment. Takes an angle such as "40 arcsec". Left out: no limit."""
    gyro_scale: str
    """Each gyro scale factor. Takes a ratio such as "30 ppm". Left out: no limit."""
    heading: str
    """Heading. Takes an angle such as "30.5 deg". Left out: twice the azimuth of prior.attitude, or ten times
    what angle_random_walk leaves of the heading by Earth rate over the duration: the larger one."""
    tilt: str
    """Tilt, the larger one of north and east. Takes an angle such as "30.5 deg". Left out: twice the tilt of
    prior.attitude, or twice prior.accel_bias over gravity: the larger one."""

class ProcedureCalibration(Section):
    """Turning through positions and estimating the sensors' errors. Takes a table with positions, stops, name,
    passes, duration, estimator, error_model, g_states, not_estimated, refuse_above_mean_nis,
    refuse_above_sigma, further, prior, aiding, least_squares. Left out: no calibration: navigate at once."""

    @property
    def aiding(self) -> ProcedureCalibrationAiding:
        """The reference that the filter measures against. Takes a table with reference, period, sway, sigma,
        noise."""
    @aiding.setter
    def aiding(self, value: ProcedureCalibrationAiding | Mapping[str, Any]) -> None: ...
    duration: str
    """Whole time: moves and dwells of all passes. Takes a time such as "12 h". Default: "4 h"."""
    error_model: Literal["phi", "psi"]
    """Form of the filter's system error model. Takes one of "phi", "psi". Default: "phi"."""
    estimator: Literal["kalman", "least-squares", "external-turntable"]
    """How the parameters are estimated. Takes one of "kalman", "least-squares", "external-turntable". Default:
    "kalman"."""
    @property
    def further(self) -> ProcedureCalibrationFurther:
        """Errors beside the thirty parameters that the filter considers or estimates. Takes a table with
        accel_lever, gyro_asymmetry, accel_asymmetry, accel_quadratic, gyro_gauss_markov,
        gyro_correlation_time, accel_gauss_markov, accel_correlation_time, gyro_rate_random_walk, deflection,
        gravity_anomaly, gyro_bias_temperature, gyro_scale_temperature, accel_bias_temperature,
        accel_scale_temperature, temperature_reference_c, gimbal_angles. Left out: none."""
    @further.setter
    def further(self, value: ProcedureCalibrationFurther | Mapping[str, Any]) -> None: ...
    g_states: bool
    """Whether the filter estimates the g-dependent biases. Takes true or false. Default: true."""
    @property
    def least_squares(self) -> ProcedureCalibrationLeastSquares:
        """Settings of the least-squares estimator. Takes a table with gravity, gyro, intervals, initial, window,
        threshold, shortest."""
    @least_squares.setter
    def least_squares(self, value: ProcedureCalibrationLeastSquares | Mapping[str, Any]) -> None: ...
    name: str
    """Name of the sequence of one's own, in tables, reports and on the terminal. Takes a text in quotes. Left
    out: "own stops"."""
    not_estimated: Sequence[Literal["gyro_bias", "gyro_scale", "gyro_misalignment", "g_dependent", "accel_bias", "accel_scale", "accel_misalignment"]]
    """Further parameter groups that the filter does not estimate. Takes a list of some of gyro_bias, gyro_scale,
    gyro_misalignment, g_dependent, accel_bias, accel_scale, accel_misalignment. Default: []."""
    passes: int
    """How often the sequence is walked within the duration. Takes a whole number from 1 to 1000. Default: 1."""
    positions: Literal["six", "eight", "eight-level", "eight-same-plane", "twelve", "nineteen", "twenty-four"]
    """Named sequence of positions. Takes one of "six", "eight", "eight-level", "eight-same-plane", "twelve",
    "nineteen", "twenty-four". Default: "eight", unless stops are given."""
    @property
    def prior(self) -> ProcedureCalibrationPrior:
        """Standard deviations that the filter starts from. Takes a table with attitude, velocity, position,
        gyro_bias, gyro_scale, gyro_misalignment, g_dependent, accel_bias, accel_scale, accel_misalignment."""
    @prior.setter
    def prior(self, value: ProcedureCalibrationPrior | Mapping[str, Any]) -> None: ...
    refuse_above_mean_nis: float
    """Mean normalized innovation squared (three axes) above which the calibration is refused. Takes a number
    above 0. Default: 9.0."""
    @property
    def refuse_above_sigma(self) -> ProcedureCalibrationRefuseAboveSigma:
        """Largest standard deviations at the end of a calibration that is published. Takes a table with heading,
        tilt, gyro_bias, gyro_scale, gyro_misalignment, g_dependent, accel_bias, accel_scale,
        accel_misalignment."""
    @refuse_above_sigma.setter
    def refuse_above_sigma(self, value: ProcedureCalibrationRefuseAboveSigma | Mapping[str, Any]) -> None: ...
    stops: Sequence[Mapping[str, Any]]
    """A sequence of one's own. Takes an array of tables with azimuth, roll, weight. Left out: positions are
    used."""

class ProcedureHeadingTest(Section):
    """A test of the heading as type tests of marine instruments have it, over one run-up or several. Takes a
    table with test, run_ups, off, resolution. Left out: the heading isn't tested."""

    off: str
    """How long the unit is without power between two run-ups. Takes a time such as "12 h". Default: "12 h"."""
    resolution: str
    """Resolution of the headings that are read: they are rounded to it, and it counts as uncertainty. 0: exact.
    Takes an angle such as "30.5 deg". Default: "0 deg"."""
    run_ups: int
    """How often the unit is switched on: each run-up aligns, calibrates and navigates, and is measured. Takes a
    whole number from 1 to 20. Default: 1."""
    test: Literal["settle", "settle-in-motion", "scorsby", "dynamic"]
    """What is tested. The table's motion is that of motion.ship. Takes one of "settle", "settle-in-motion",
    "scorsby", "dynamic"."""

class ProcedureInitialParameters(Section):
    """Parameters that the core starts from, of an earlier calibration. Takes a table with table, gyro_bias,
    gyro_scale, gyro_misalignment, g_dependent, accel_bias, accel_scale, accel_misalignment. Left out: zero."""

    accel_bias: Sequence[str]
    """x, y, z. Takes an array of 3, each an acceleration such as "100 ug". Left out: zero."""
    accel_misalignment: Sequence[str]
    """yx, zx, zy. Takes an array of 3, each an angle such as "40 arcsec". Left out: zero."""
    accel_scale: Sequence[str]
    """x, y, z. Takes an array of 3, each a ratio such as "30 ppm". Left out: zero."""
    g_dependent: Sequence[str]
    """By rows. Takes an array of 9, each a g-dependent gyro bias such as "0.0005 deg/h/g". Left out: zero."""
    gyro_bias: Sequence[str]
    """x, y, z. Takes an array of 3, each an angular rate such as "0.005 deg/h". Left out: zero."""
    gyro_misalignment: Sequence[str]
    """xy, xz, yx, yz, zx, zy. Takes an array of 6, each an angle such as "40 arcsec". Left out: zero."""
    gyro_scale: Sequence[str]
    """x, y, z. Takes an array of 3, each a ratio such as "30 ppm". Left out: zero."""
    table: str
    """Calibration table of an earlier run, such as runs/quick/calibration.octcal, relative to the scenario's
    folder; stands in place of the groups. Takes a text in quotes. Left out: the groups below."""

class ProcedureNavigation(Section):
    """Free inertial navigation with the compensated sensors, height held. Takes a table with duration, rotation,
    dwell. Left out: no navigation: the run ends with the calibration."""

    duration: str
    """How long. Takes a time such as "12 h". Default: plant: has to be given; recordings: until they end."""
    dwell: str
    """Rest at each stop of weight 1; the move to the next stop comes on top. Takes a time such as "12 h".
    Default: "300 s"."""
    rotation: Literal["sixteen", "tetrahedral", "none"] | Sequence[Mapping[str, Any]]
    """Rotation while navigating: a named scheme, or stops that are repeated. Takes one of "sixteen",
    "tetrahedral", "none", or an array of tables with azimuth, roll, weight. Default: "sixteen"."""

class Procedure(Section):
    """What the core does: align, calibrate, navigate. Takes a table with alignment, calibration, navigation,
    heading_test, initial_parameters."""

    @property
    def alignment(self) -> ProcedureAlignment:
        """How the initial attitude is found. Takes a table with method, tilt, azimuth, velocity, attitude_error,
        velocity_error, duration."""
    @alignment.setter
    def alignment(self, value: ProcedureAlignment | Mapping[str, Any]) -> None: ...
    @property
    def calibration(self) -> ProcedureCalibration:
        """Turning through positions and estimating the sensors' errors. Takes a table with positions, stops,
        name, passes, duration, estimator, error_model, g_states, not_estimated, refuse_above_mean_nis,
        refuse_above_sigma, further, prior, aiding, least_squares. Left out: no calibration: navigate at once."""
    @calibration.setter
    def calibration(self, value: ProcedureCalibration | Mapping[str, Any]) -> None: ...
    @property
    def heading_test(self) -> ProcedureHeadingTest:
        """A test of the heading as type tests of marine instruments have it, over one run-up or several. Takes a
        table with test, run_ups, off, resolution. Left out: the heading isn't tested."""
    @heading_test.setter
    def heading_test(self, value: ProcedureHeadingTest | Mapping[str, Any]) -> None: ...
    @property
    def initial_parameters(self) -> ProcedureInitialParameters:
        """Parameters that the core starts from, of an earlier calibration. Takes a table with table, gyro_bias,
        gyro_scale, gyro_misalignment, g_dependent, accel_bias, accel_scale, accel_misalignment. Left out:
        zero."""
    @initial_parameters.setter
    def initial_parameters(self, value: ProcedureInitialParameters | Mapping[str, Any]) -> None: ...
    @property
    def navigation(self) -> ProcedureNavigation:
        """Free inertial navigation with the compensated sensors, height held. Takes a table with duration,
        rotation, dwell. Left out: no navigation: the run ends with the calibration."""
    @navigation.setter
    def navigation(self, value: ProcedureNavigation | Mapping[str, Any]) -> None: ...

class Realtime(Section):
    """Whether the run goes by the clock, how, and what makes it too late. Takes a table with pace, overrun,
    overruns, lateness_p99, late_answers, silence, priority, cpu, lock_memory, spin."""

    cpu: int
    """The only processor that the thread of the samples runs on. Takes a whole number from 0 to 1023. Left out:
    any."""
    late_answers: int
    """Periods that may end without their answer; beyond, the run is inconclusive. Takes a whole number of 0 or
    more. Default: 0."""
    lateness_p99: str
    """Largest lateness of 99 % of the samples; beyond, the run is inconclusive. Takes a time such as "500 us".
    Left out: no limit."""
    lock_memory: bool
    """All memory of the program stays in place. Takes true or false. Default: true."""
    overrun: str
    """A sample that leaves later than this is an overrun. Takes a time such as "500 us". Default: "1 ms"."""
    overruns: int
    """Overruns that are allowed; beyond, the run is inconclusive. Takes a whole number of 0 or more. Default: 0."""
    pace: Literal["free", "clock"]
    """What a run goes by. What is computed is the same. Takes one of "free", "clock". Default: "free"."""
    priority: int
    """Priority of SCHED_FIFO that the thread of the samples asks for; 0: none. Takes a whole number from 0 to
    99. Default: 80."""
    silence: str
    """An endpoint that owes an answer for longer is gone, which ends the run. Takes a time such as "500 us".
    Default: "1 s"."""
    spin: str
    """The last part of each wait that is spent looking at the clock, where a real-time priority was granted.
    Takes a time such as "500 us". Default: "0 s"."""

class Record(Section):
    """What is recorded, and how often. Takes a table with rate, samples, parameters, topics, topics_period."""

    parameters: str
    """Shortest time between two records of the estimated parameters. Takes a time such as "12 h". Default: "10
    s"."""
    rate: str
    """Rate of truth, output and decimated samples; a whole number of samples apart. Takes a frequency such as
    "200 Hz". Default: "1 Hz"."""
    samples: Literal["decimated", "full"]
    """Which samples are kept. Takes one of "decimated", "full". Default: "decimated"."""
    topics: Literal["on", "off"]
    """Topics for other tools in the recording: standard messages of ROS 2, and the JSON of a live run. Takes one
    of "on", "off". Default: "on"."""
    topics_period: str
    """Shortest time between two messages on each of these topics; at changes of mode there is one too. Takes a
    time such as "12 h". Default: "10 s"."""

class Screening(Section):
    """Screens and gates of the core. Takes a table with gate, stuck_samples, jumps, bridging, gimbals, drift,
    checkpoints, aiding_stamps."""

    aiding_stamps: Literal["on", "off"]
    """Aiding that doesn't carry the stamp of its sample is not used. Takes one of "on", "off". Default: "on"."""
    bridging: Literal["on", "off"]
    """Samples missing, invalid, stuck or not believed are bridged by what is known of the motion; off: used as
    they are. Takes one of "on", "off". Default: "on"."""
    checkpoints: Literal["on", "off"]
    """A recovery goes back to the parameters of one to two minutes before it. Takes one of "on", "off". Default:
    "on"."""
    drift: Literal["off"] | float
    """Correction of a parameter over a stretch of the calibration, in its standard deviations, above which the
    calibration is refused. Takes "off", or a number above 0. Default: static: 5; dockside: 6."""
    gate: Literal["off"] | Mapping[str, Any]
    """Innovation gate. Takes "off", or a table with nis, rejections, recovery. Default: {}."""
    gimbals: Literal["on", "off"]
    """Turns by gyros and by encoders are compared, and encoders with the set point. Takes one of "on", "off".
    Default: "on"."""
    jumps: Literal["on", "off"]
    """Samples that jump as no motion of turntable and base can are not believed. Takes one of "on", "off".
    Default: "on"."""
    stuck_samples: Literal["off"] | int
    """Identical counts in a row that make a channel stuck. Takes "off", or a whole number from 2 to 1000000.
    Default: 8."""

class SiteDrawnDeflection(Section):
    """Deflection of the vertical, north and east. Takes a table with one of normal, uniform. Left out: as given."""

    normal: str
    """Drawn from a normal distribution of this standard deviation, each entry alone. Takes an angle such as "40
    arcsec". Left out: another is given."""
    uniform: str
    """Drawn evenly within plus and minus this half width, each entry alone. Takes an angle such as "40 arcsec".
    Left out: another is given."""

class SiteDrawnGravityAnomaly(Section):
    """True minus normal gravity. Takes a table with one of normal, uniform. Left out: as given."""

    normal: str
    """Drawn from a normal distribution of this standard deviation, each entry alone. Takes an acceleration such
    as "100 ug". Left out: another is given."""
    uniform: str
    """Drawn evenly within plus and minus this half width, each entry alone. Takes an acceleration such as "100
    ug". Left out: another is given."""

class SiteDrawn(Section):
    """Errors of gravity that the seed draws, each group from its own stream; they add to the values given above.
    Takes a table with deflection, gravity_anomaly. Left out: nothing is drawn."""

    @property
    def deflection(self) -> SiteDrawnDeflection:
        """Deflection of the vertical, north and east. Takes a table with one of normal, uniform. Left out: as
        given."""
    @deflection.setter
    def deflection(self, value: SiteDrawnDeflection | Mapping[str, Any]) -> None: ...
    @property
    def gravity_anomaly(self) -> SiteDrawnGravityAnomaly:
        """True minus normal gravity. Takes a table with one of normal, uniform. Left out: as given."""
    @gravity_anomaly.setter
    def gravity_anomaly(self, value: SiteDrawnGravityAnomaly | Mapping[str, Any]) -> None: ...

class Site(Section):
    """Where the instrument stands. Takes a table with latitude, longitude, height, deflection_north,
    deflection_east, gravity_anomaly, drawn."""

    deflection_east: str
    """Deflection of the vertical to the east (η). Takes an angle such as "40 arcsec". Default: "0 arcsec"."""
    deflection_north: str
    """Deflection of the vertical to the north (ξ): positive where the astronomic zenith is north of the geodetic
    one. Takes an angle such as "40 arcsec". Default: "0 arcsec"."""
    @property
    def drawn(self) -> SiteDrawn:
        """Errors of gravity that the seed draws, each group from its own stream; they add to the values given
        above. Takes a table with deflection, gravity_anomaly. Left out: nothing is drawn."""
    @drawn.setter
    def drawn(self, value: SiteDrawn | Mapping[str, Any]) -> None: ...
    gravity_anomaly: str
    """True minus normal gravity. Takes an acceleration such as "100 ug". Default: "0 ug"."""
    height: str
    """Height above the ellipsoid. Takes a length such as "0.15 m". Default: "0 m"."""
    latitude: str
    """Geodetic latitude, north positive. Takes an angle such as "30.5 deg". Default: "30.5 deg"."""
    longitude: str
    """Longitude, east positive. Takes an angle such as "30.5 deg". Default: "114.4 deg"."""

class SourceFmuMapAccelerometer(Section):
    """Accelerometers: specific force or increments. Takes a table with specific_force, delta_velocity. Left out:
    the variable of the channel's own name, where the FMU has it."""

    delta_velocity: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """Velocity increments over the sample's interval, x y z. Takes the name of an array variable, or 3 entries,
    each the name of a variable, or a table with variable (and unit, scale) or constant. Left out: the
    variable of the channel's own name, where the FMU has it."""
    specific_force: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """Specific force, x y z (at rest it points up), taken as constant over the sample's interval. Takes the name
    of an array variable, or 3 entries, each the name of a variable, or a table with variable (and unit,
    scale) or constant. Left out: the variable of the channel's own name, where the FMU has it."""

class SourceFmuMapCase(Section):
    """Motion of the case, of a ship or a turntable: the simulated instrument stands on it. Needs motion.kind =
    "dockside", whose sway then only tells the core what to expect. Takes a table with heading, pitch, roll,
    north, east, down, latitude, longitude, height. Left out: the variable of the channel's own name, where
    the FMU has it."""

    down: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """Distance of the case below the site. Takes the name of a variable, or a table with variable (and unit,
    scale) or constant. Left out: the variable of the channel's own name, where the FMU has it."""
    east: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """Distance of the case east of the site. Takes the name of a variable, or a table with variable (and unit,
    scale) or constant. Left out: the variable of the channel's own name, where the FMU has it."""
    heading: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """Heading of the case, from north over east. Takes the name of a variable, or a table with variable (and
    unit, scale) or constant. Left out: the variable of the channel's own name, where the FMU has it."""
    height: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """Height of the case above the ellipsoid, instead of down. Takes the name of a variable, or a table with
    variable (and unit, scale) or constant. Left out: the variable of the channel's own name, where the FMU
    has it."""
    latitude: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """Geodetic latitude of the case, instead of north. Takes the name of a variable, or a table with variable
    (and unit, scale) or constant. Left out: the variable of the channel's own name, where the FMU has it."""
    longitude: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """Longitude of the case, instead of east. Takes the name of a variable, or a table with variable (and unit,
    scale) or constant. Left out: the variable of the channel's own name, where the FMU has it."""
    north: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """Distance of the case north of the site. Takes the name of a variable, or a table with variable (and unit,
    scale) or constant. Left out: the variable of the channel's own name, where the FMU has it."""
    pitch: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """Pitch of the case, bow up positive. Takes the name of a variable, or a table with variable (and unit,
    scale) or constant. Left out: the variable of the channel's own name, where the FMU has it."""
    roll: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """Roll of the case, starboard down positive. Takes the name of a variable, or a table with variable (and
    unit, scale) or constant. Left out: the variable of the channel's own name, where the FMU has it."""

class SourceFmuMapGimbal(Section):
    """Encoders; without them the angles are flagged invalid. Takes a table with azimuth, roll. Left out: the
    variable of the channel's own name, where the FMU has it."""

    azimuth: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """Angle of the inner gimbal at the stamp, cumulative. Takes the name of a variable, or a table with variable
    (and unit, scale) or constant. Left out: the variable of the channel's own name, where the FMU has it."""
    roll: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """Angle of the outer gimbal at the stamp, cumulative. Takes the name of a variable, or a table with variable
    (and unit, scale) or constant. Left out: the variable of the channel's own name, where the FMU has it."""

class SourceFmuMapGimbalCommand(Section):
    """Inputs of the FMU: where the core wants the gimbals. Without them the FMU turns as it likes. Takes a table
    with azimuth, roll. Left out: the variable of the channel's own name, where the FMU has it."""

    azimuth: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """Set point of the inner gimbal, cumulative. Takes the name of a variable, or a table with variable (and
    unit, scale) or constant. Left out: the variable of the channel's own name, where the FMU has it."""
    roll: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """Set point of the outer gimbal, cumulative. Takes the name of a variable, or a table with variable (and
    unit, scale) or constant. Left out: the variable of the channel's own name, where the FMU has it."""

class SourceFmuMapGyro(Section):
    """Gyros: rates or increments. Takes a table with rate, delta_theta. Left out: the variable of the channel's
    own name, where the FMU has it."""

    delta_theta: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """Angle increments over the sample's interval, x y z. Takes the name of an array variable, or 3 entries,
    each the name of a variable, or a table with variable (and unit, scale) or constant. Left out: the
    variable of the channel's own name, where the FMU has it."""
    rate: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """Angular rate of the body, x y z, taken as constant over the sample's interval. Takes the name of an array
    variable, or 3 entries, each the name of a variable, or a table with variable (and unit, scale) or
    constant. Left out: the variable of the channel's own name, where the FMU has it."""

class SourceFmuMapImu(Section):
    """Flags and stamps of samples. Takes a table with valid, status, sequence, device_time_ns. Left out: the
    variable of the channel's own name, where the FMU has it."""

    device_time_ns: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """Stamp of the sample, ns since the start of the first interval. Takes the name of a variable, or a table
    with variable (and unit, scale) or constant. Left out: the variable of the channel's own name, where the
    FMU has it."""
    sequence: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """Number of the sample, from 1. Takes the name of a variable, or a table with variable (and unit, scale) or
    constant. Left out: the variable of the channel's own name, where the FMU has it."""
    status: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """Flags of the sample: 1 gyro saturated, 2 accelerometer saturated, 4 gimbal angles invalid, 8 inertial
    counts invalid. Takes the name of a variable, or a table with variable (and unit, scale) or constant. Left
    out: the variable of the channel's own name, where the FMU has it."""
    valid: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """Whether there is a sample; without one none is delivered. Takes the name of a variable, or a table with
    variable (and unit, scale) or constant. Left out: the variable of the channel's own name, where the FMU
    has it."""

class SourceFmuMapReference(Section):
    """The reference of a calibration: a velocity or a position. Takes a table with kind, valid, velocity,
    latitude, longitude, height, age_ns. Left out: the variable of the channel's own name, where the FMU has
    it."""

    age_ns: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """Stamp of the sample minus that of its reference, ns. Takes the name of a variable, or a table with
    variable (and unit, scale) or constant. Left out: the variable of the channel's own name, where the FMU
    has it."""
    height: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """Height above the ellipsoid that the reference measured. Takes the name of a variable, or a table with
    variable (and unit, scale) or constant. Left out: the variable of the channel's own name, where the FMU
    has it."""
    kind: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """Whether a reference goes with the sample: 0 none, 1 velocity, 2 position. Takes the name of a variable, or
    a table with variable (and unit, scale) or constant. Left out: the variable of the channel's own name,
    where the FMU has it."""
    latitude: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """Geodetic latitude that the reference measured. Takes the name of a variable, or a table with variable (and
    unit, scale) or constant. Left out: the variable of the channel's own name, where the FMU has it."""
    longitude: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """Longitude that the reference measured. Takes the name of a variable, or a table with variable (and unit,
    scale) or constant. Left out: the variable of the channel's own name, where the FMU has it."""
    valid: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """Whether a reference goes with the sample. Takes the name of a variable, or a table with variable (and
    unit, scale) or constant. Left out: the variable of the channel's own name, where the FMU has it."""
    velocity: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """Velocity over ground that the reference measured: north, east, down. Takes the name of an array variable,
    or 3 entries, each the name of a variable, or a table with variable (and unit, scale) or constant. Left
    out: the variable of the channel's own name, where the FMU has it."""

class SourceFmuMapTruthGimbal(Section):
    """True angles of the gimbals; left out: those of the encoders. Takes a table with azimuth, roll. Left out:
    the variable of the channel's own name, where the FMU has it."""

    azimuth: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """True angle of the inner gimbal, without encoder error. Takes the name of a variable, or a table with
    variable (and unit, scale) or constant. Left out: the variable of the channel's own name, where the FMU
    has it."""
    roll: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """True angle of the outer gimbal, without encoder error. Takes the name of a variable, or a table with
    variable (and unit, scale) or constant. Left out: the variable of the channel's own name, where the FMU
    has it."""

class SourceFmuMapTruth(Section):
    """Truth, for scoring the navigation. Takes a table with latitude, longitude, height, velocity, attitude,
    gimbal. Left out: the variable of the channel's own name, where the FMU has it."""

    attitude: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """True attitude of the body as a quaternion w x y z that takes a vector in body into north, east, down.
    Takes the name of an array variable, or 4 entries, each the name of a variable, or a table with variable
    (and unit, scale) or constant. Left out: the variable of the channel's own name, where the FMU has it."""
    @property
    def gimbal(self) -> SourceFmuMapTruthGimbal:
        """True angles of the gimbals; left out: those of the encoders. Takes a table with azimuth, roll. Left
        out: the variable of the channel's own name, where the FMU has it."""
    @gimbal.setter
    def gimbal(self, value: SourceFmuMapTruthGimbal | Mapping[str, Any]) -> None: ...
    height: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """True height above the ellipsoid. Takes the name of a variable, or a table with variable (and unit, scale)
    or constant. Left out: the variable of the channel's own name, where the FMU has it."""
    latitude: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """True geodetic latitude at the stamp. Takes the name of a variable, or a table with variable (and unit,
    scale) or constant. Left out: the variable of the channel's own name, where the FMU has it."""
    longitude: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """True longitude at the stamp. Takes the name of a variable, or a table with variable (and unit, scale) or
    constant. Left out: the variable of the channel's own name, where the FMU has it."""
    velocity: str | Mapping[str, Any] | Sequence[str | Mapping[str, Any]]
    """True velocity over ground: north, east, down. Takes the name of an array variable, or 3 entries, each the
    name of a variable, or a table with variable (and unit, scale) or constant. Left out: the variable of the
    channel's own name, where the FMU has it."""

class SourceFmuMap(Section):
    """Which variable of the FMU is what. Units are converted as the FMU's description says; a name after a minus
    sign is negated. Takes a table with gyro, accelerometer, gimbal, gimbal_command, imu, reference, truth,
    case. Left out: the variable of the channel's own name, where the FMU has it."""

    @property
    def accelerometer(self) -> SourceFmuMapAccelerometer:
        """Accelerometers: specific force or increments. Takes a table with specific_force, delta_velocity. Left
        out: the variable of the channel's own name, where the FMU has it."""
    @accelerometer.setter
    def accelerometer(self, value: SourceFmuMapAccelerometer | Mapping[str, Any]) -> None: ...
    @property
    def case(self) -> SourceFmuMapCase:
        """Motion of the case, of a ship or a turntable: the simulated instrument stands on it. Needs motion.kind
        = "dockside", whose sway then only tells the core what to expect. Takes a table with heading, pitch,
        roll, north, east, down, latitude, longitude, height. Left out: the variable of the channel's own
        name, where the FMU has it."""
    @case.setter
    def case(self, value: SourceFmuMapCase | Mapping[str, Any]) -> None: ...
    @property
    def gimbal(self) -> SourceFmuMapGimbal:
        """Encoders; without them the angles are flagged invalid. Takes a table with azimuth, roll. Left out: the
        variable of the channel's own name, where the FMU has it."""
    @gimbal.setter
    def gimbal(self, value: SourceFmuMapGimbal | Mapping[str, Any]) -> None: ...
    @property
    def gimbal_command(self) -> SourceFmuMapGimbalCommand:
        """Inputs of the FMU: where the core wants the gimbals. Without them the FMU turns as it likes. Takes a
        table with azimuth, roll. Left out: the variable of the channel's own name, where the FMU has it."""
    @gimbal_command.setter
    def gimbal_command(self, value: SourceFmuMapGimbalCommand | Mapping[str, Any]) -> None: ...
    @property
    def gyro(self) -> SourceFmuMapGyro:
        """Gyros: rates or increments. Takes a table with rate, delta_theta. Left out: the variable of the
        channel's own name, where the FMU has it."""
    @gyro.setter
    def gyro(self, value: SourceFmuMapGyro | Mapping[str, Any]) -> None: ...
    @property
    def imu(self) -> SourceFmuMapImu:
        """Flags and stamps of samples. Takes a table with valid, status, sequence, device_time_ns. Left out: the
        variable of the channel's own name, where the FMU has it."""
    @imu.setter
    def imu(self, value: SourceFmuMapImu | Mapping[str, Any]) -> None: ...
    @property
    def reference(self) -> SourceFmuMapReference:
        """The reference of a calibration: a velocity or a position. Takes a table with kind, valid, velocity,
        latitude, longitude, height, age_ns. Left out: the variable of the channel's own name, where the FMU
        has it."""
    @reference.setter
    def reference(self, value: SourceFmuMapReference | Mapping[str, Any]) -> None: ...
    @property
    def truth(self) -> SourceFmuMapTruth:
        """Truth, for scoring the navigation. Takes a table with latitude, longitude, height, velocity, attitude,
        gimbal. Left out: the variable of the channel's own name, where the FMU has it."""
    @truth.setter
    def truth(self, value: SourceFmuMapTruth | Mapping[str, Any]) -> None: ...

class SourceFmu(Section):
    """How the FMU of source.uri is run, and what its variables are. Takes a table with interface, process,
    time_limit, allow_tool, step, tolerance, parameters, map. Default: fmu: the defaults of its keys."""

    allow_tool: bool
    """Whether the FMU is run although it needs the tool that made it, which has to be installed. Takes true or
    false. Default: false."""
    interface: Literal["auto", "co-simulation", "model-exchange"]
    """Interface type of the FMU. Takes one of "auto", "co-simulation", "model-exchange". Default: "auto"."""
    @property
    def map(self) -> SourceFmuMap:
        """Which variable of the FMU is what. Units are converted as the FMU's description says; a name after a
        minus sign is negated. Takes a table with gyro, accelerometer, gimbal, gimbal_command, imu, reference,
        truth, case. Left out: the variable of the channel's own name, where the FMU has it."""
    @map.setter
    def map(self, value: SourceFmuMap | Mapping[str, Any]) -> None: ...
    parameters: Mapping[str, Any]
    """Values of the FMU's parameters, and of inputs that are held: a number is in the variable's own unit, a
    quantity is converted into it. Takes a table of names and values. Left out: nothing is set."""
    process: Literal["own", "shared"]
    """Where the FMU runs. Takes one of "own", "shared". Default: "own"."""
    step: str
    """Communication step: a whole part of the sample period, or of a ship a multiple of it, between which its
    motion is interpolated. Takes a time such as "12 h". Default: the sample period."""
    time_limit: str
    """Wall time that one call of the FMU may take; longer, and it counts as hung. Takes a time such as "12 h".
    Default: in a process of its own: "10 s"; in the shared one: none, nothing can end a call."""
    tolerance: float
    """Relative tolerance of the FMU's solver, or of Octant's in model exchange. Takes a number from 1e-14 to
    0.1. Left out: that of the FMU's default experiment."""

class SourceLive(Section):
    """What the instrument of source.uri speaks, and how it is mounted. Takes a table with protocol, database,
    mapping, description, axes, gyro_count, accel_count, silence, pps, pps_edge, pps_silence, stamps,
    stamps_within, host_clock, host_within, tai_offset. Default: serial, udp, tcp, can and slcan: the defaults
    of its keys."""

    accel_count: str
    """Velocity of one accelerometer count, likewise. Takes a velocity such as "1 mm/s". Left out: by the kind of
    unit."""
    axes: str
    """Which axes of the instrument body x, y and z are, with a minus for the opposite: x -y -z. Takes a text in
    quotes. Default: "x y z"."""
    database: str
    """The maker's CAN database, a DBC file. Relative to the scenario. Takes a text in quotes. Left out: needed
    by protocol = "dbc"."""
    description: str
    """Description of the unit's frames: a TOML file, relative to the scenario, or the name of one that comes
    with Octant, such as kvh-1775-rate. Takes a text in quotes. Left out: needed by protocol = "described"."""
    gyro_count: str
    """Angle of one gyro count of a NovAtel receiver's unit, in place of the table's, for a kind that the table
    lacks; with accel_count. Takes an angle such as "40 arcsec". Left out: by the kind of unit."""
    host_clock: str
    """Clock of a network card that PTP keeps at TAI, such as /dev/ptp0, by which the stamps are related to the
    host's time. Takes a text in quotes. Left out: the host's realtime clock."""
    host_within: str
    """Bound of the error of the host's clock, with source.live.stamps. Takes a time such as "12 h". Left out:
    what the kernel says of its realtime clock, which has to be synchronised."""
    mapping: str
    """Which signals of the database are which channels, a TOML file. Relative to the scenario. Takes a text in
    quotes. Left out: needed by protocol = "dbc"."""
    pps: str
    """Pulses at the whole seconds of the unit's stamps (1PPS), which give samples their time: a device such as
    /dev/pps0, or a file of the kernel's form. Takes a text in quotes. Left out: samples have the time of
    their arrival."""
    pps_edge: Literal["assert", "clear"]
    """Edge of the pulse at which the second begins. Takes one of "assert", "clear". Default: "assert"."""
    pps_silence: str
    """How long a pulse is waited for; then the run ends. Takes a time such as "12 h". Default: "10 s"."""
    protocol: Literal["octant", "vectornav", "xsens", "novatel", "sbg", "described", "dbc"]
    """What the instrument speaks. Takes one of "octant", "vectornav", "xsens", "novatel", "sbg", "described",
    "dbc". Default: "octant"; on a CAN bus "dbc"."""
    silence: str
    """How long a reading is waited for; then the instrument is gone. Takes a time such as "12 h". Default: "5
    s"."""
    stamps: Literal["own", "utc", "tai", "gps"]
    """Time scale of the unit's stamps. By a known one a stamp is the time itself. Takes one of "own", "utc",
    "tai", "gps". Default: "own"."""
    stamps_within: str
    """Bound of the error of the stamps; with source.live.pps of the time between a whole second of them and the
    kernel's stamp of its pulse. It is part of the uncertainty of a sample's time. Takes a time such as "12
    h". Left out: 20 us with source.live.pps, the latency of an interrupt."""
    tai_offset: int
    """Seconds by which TAI is ahead of UTC, for stamps by tai and gps: 37 since 2017. Takes a whole number from
    10 to 100. Left out: the kernel's."""

class SourceLog(Section):
    """What the instrument spoke whose bytes source.uri names, and how it was mounted. Takes a table with
    protocol, description, axes, gyro_count, accel_count. Default: needed by log:FILE."""

    accel_count: str
    """Velocity of one accelerometer count, likewise. Takes a velocity such as "1 mm/s". Left out: by the kind of
    unit."""
    axes: str
    """Which axes of the instrument body x, y and z are, with a minus for the opposite: x -y -z. Takes a text in
    quotes. Default: "x y z"."""
    description: str
    """Description of the unit's frames: a TOML file, relative to the scenario, or the name of one that comes
    with Octant, such as kvh-1775-rate. Takes a text in quotes. Left out: needed by protocol = "described"."""
    gyro_count: str
    """Angle of one gyro count of a NovAtel receiver's unit, in place of the table's, for a kind that the table
    lacks; with accel_count. Takes an angle such as "40 arcsec". Left out: by the kind of unit."""
    protocol: Literal["vectornav", "xsens", "novatel", "sbg", "octant", "described"]
    """What the instrument spoke. Takes one of "vectornav", "xsens", "novatel", "sbg", "octant", "described"."""

class SourceMcapAccelerometer(Section):
    """Fields of the accelerometers. Takes a table with topic, x, y, z, unit, quantity, scale, offset, axes."""

    axes: Sequence[Literal["x", "-x", "y", "-y", "z", "-z"]]
    """Which instrument axis, with its sign, lies along body x, y and z. Takes a list of some of x, -x, y, -y, z,
    -z. Default: ["x", "y", "z"]."""
    offset: Sequence[float]
    """Raw number of zero, x, y, z. Takes 3 numbers. Default: [0.0, 0.0, 0.0]."""
    quantity: Literal["rate", "increment"]
    """Specific force or increments. Takes one of "rate", "increment". Default: "rate"."""
    scale: Sequence[float]
    """Unit per raw number, x, y, z, before axes are exchanged: value = (raw − offset) · scale. Takes 3 numbers.
    Default: [1.0, 1.0, 1.0]."""
    topic: str
    """Topic of the accelerometers, where it isn't that of the gyros: messages with equal stamps are taken
    together. Takes a text in quotes. Default: source.mcap.topic."""
    unit: Literal["m/s^2", "g", "mg", "m/s", "mm/s"]
    """Unit after scaling. Takes one of "m/s^2", "g", "mg", "m/s", "mm/s". Default: "m/s^2"."""
    x: str
    """Dotted name of the field of x. Takes a text in quotes."""
    y: str
    """Field of y. Takes a text in quotes."""
    z: str
    """Field of z. Takes a text in quotes."""

class SourceMcapGyro(Section):
    """Fields of the gyros. Takes a table with x, y, z, unit, quantity, scale, offset, axes."""

    axes: Sequence[Literal["x", "-x", "y", "-y", "z", "-z"]]
    """Which instrument axis, with its sign, lies along body x, y and z. Takes a list of some of x, -x, y, -y, z,
    -z. Default: ["x", "y", "z"]."""
    offset: Sequence[float]
    """Raw number of zero, x, y, z. Takes 3 numbers. Default: [0.0, 0.0, 0.0]."""
    quantity: Literal["rate", "increment"]
    """Rates or increments. Takes one of "rate", "increment". Default: "rate"."""
    scale: Sequence[float]
    """Unit per raw number, x, y, z, before axes are exchanged: value = (raw − offset) · scale. Takes 3 numbers.
    Default: [1.0, 1.0, 1.0]."""
    unit: Literal["rad/s", "deg/s", "deg/h", "rad", "deg", "arcsec"]
    """Unit after scaling. Takes one of "rad/s", "deg/s", "deg/h", "rad", "deg", "arcsec". Default: "rad/s"."""
    x: str
    """Dotted name of the field of x. Takes a text in quotes."""
    y: str
    """Field of y. Takes a text in quotes."""
    z: str
    """Field of z. Takes a text in quotes."""

class SourceMcap(Section):
    """Which channels and fields of another program's MCAP file are read. Takes a table with topic, time_field,
    nanoseconds_field, time_unit, temperature_field, temperature_unit, rate, split, gyro, accelerometer.
    Default: replay: the channels that this program writes."""

    @property
    def accelerometer(self) -> SourceMcapAccelerometer:
        """Fields of the accelerometers. Takes a table with topic, x, y, z, unit, quantity, scale, offset, axes."""
    @accelerometer.setter
    def accelerometer(self, value: SourceMcapAccelerometer | Mapping[str, Any]) -> None: ...
    @property
    def gyro(self) -> SourceMcapGyro:
        """Fields of the gyros. Takes a table with x, y, z, unit, quantity, scale, offset, axes."""
    @gyro.setter
    def gyro(self, value: SourceMcapGyro | Mapping[str, Any]) -> None: ...
    nanoseconds_field: str
    """Dotted name of a field with nanoseconds to add, as stamps of ROS have them. Takes a text in quotes. Left
    out: the time stamp is one number."""
    rate: str
    """Nominal rate of the messages: times split, it is imu.rate. Takes a frequency such as "200 Hz". Default:
    imu.rate divided by split."""
    split: int
    """Samples that a row or message becomes, equal parts of its interval, so that counts hold faster rates (179
    deg/s at 100 Hz, 358 deg/s at 200 Hz). Takes a whole number from 1 to 1000. Default: 1."""
    temperature_field: str
    """Dotted name of the field with the instrument's temperature; octant characterise reads it. Takes a text in
    quotes. Left out: the messages have no temperature."""
    temperature_unit: Literal["degC", "K"]
    """Unit of the temperature. Takes one of "degC", "K". Default: "degC"."""
    time_field: str
    """Dotted name of the field with the time stamp, a number. Takes a text in quotes. Default: the message's log
    time."""
    time_unit: Literal["s", "ms", "us", "ns"]
    """Unit of the time stamp. Takes one of "s", "ms", "us", "ns". Default: "ns"."""
    topic: str
    """Topic of the inertial samples, or of the gyros. Takes a text in quotes."""

class SourceReference(Section):
    """The reference of a calibration, where the source brings none: what is known of the motion of text, another
    program's MCAP file or an instrument on a port, or what was measured and recorded beside the samples.
    Takes a table with kind, north, east, down, up, latitude, longitude, height, unit, file, delimiter,
    skip_lines, header, comment, time_column, topic, time_field, nanoseconds_field, time_unit. Left out: the
    source brings its own, or there is none."""

    comment: str
    """Lines that start with this are skipped. Takes a text in quotes. Default: a file of its own: as
    source.text."""
    delimiter: Literal["whitespace", "comma", "semicolon", "tab"]
    """What separates columns. Takes one of "whitespace", "comma", "semicolon", "tab". Default: a file of its
    own: as source.text."""
    down: int | str
    """Velocity down. Takes a column number from 1, or a column's name. Left out: up is given."""
    east: int | str
    """Velocity east. Takes a column number from 1, or a column's name. Left out: needed by kind = "velocity"."""
    file: str
    """Text: file of these columns, with stamps of the same clock. Relative to the scenario. Takes a text in
    quotes. Left out: the gyros' file."""
    header: bool
    """Whether the first line after those skipped names the columns. Takes true or false. Default: a file of its
    own: as source.text."""
    height: int | str
    """Height above the ellipsoid, m. Takes a column number from 1, or a column's name. Left out: needed by kind
    = "position"."""
    kind: Literal["static", "velocity", "position"]
    """What is known, or was measured. Takes one of "static", "velocity", "position". Default: "static"."""
    latitude: int | str
    """Geodetic latitude. Takes a column number from 1, or a column's name. Left out: needed by kind =
    "position"."""
    longitude: int | str
    """Longitude, east of Greenwich. Takes a column number from 1, or a column's name. Left out: needed by kind =
    "position"."""
    nanoseconds_field: str
    """Dotted name of a field with nanoseconds to add. Takes a text in quotes. Left out: the time stamp is one
    number."""
    north: int | str
    """Velocity north: its column, number from 1 or name; in an MCAP file the dotted name of its field. Takes a
    column number from 1, or a column's name. Left out: needed by kind = "velocity"."""
    skip_lines: int
    """Lines to skip at the start. Takes a whole number from 0 to 1000000. Default: a file of its own: as
    source.text."""
    time_column: int | str
    """Column of the time at which the reference was measured. Takes a column number from 1, or a column's name.
    Default: text: that of source.text."""
    time_field: str
    """Dotted name of the field with the time at which the reference was measured. Takes a text in quotes.
    Default: the message's log time."""
    time_unit: Literal["s", "ms", "us", "ns"]
    """Unit of the time stamp. Takes one of "s", "ms", "us", "ns". Default: text: that of source.text; MCAP: ns."""
    topic: str
    """Topic of the reference's messages. Takes a text in quotes. Left out: needed in an MCAP file."""
    unit: Literal["m/s", "mm/s", "kn", "deg", "rad"]
    """Unit of the velocities, or of latitude and longitude. Takes one of "m/s", "mm/s", "kn", "deg", "rad".
    Default: velocity: "m/s"; position: "deg"."""
    up: int | str
    """Velocity up, in place of down. Takes a column number from 1, or a column's name. Left out: down is given."""

class SourceSolution(Section):
    """How the solution of source.uri is read. Takes a table with skip, format, talker, points, heading_time,
    heading_rate, heading_start, delimiter, skip_lines, comment, time_column, time_unit, latitude, longitude,
    height, north, east, heading, pitch, roll, angle_unit, velocity_unit. Default: solution: the defaults of
    its keys."""

    angle_unit: Literal["deg", "rad"]
    """Unit of the columns of angles: position and attitude. Takes one of "deg", "rad". Default: "deg"."""
    comment: str
    """Columns of text: lines that start with this are skipped. Takes a text in quotes. Default: "#"."""
    delimiter: Literal["whitespace", "comma", "semicolon", "tab"]
    """Columns of text: what separates them. Takes one of "whitespace", "comma", "semicolon", "tab". Default:
    "comma"."""
    east: int | str
    """Velocity over ground, east. Takes a column number from 1, or a column's name. Default: the name of
    Octant's exports, where the header has it."""
    format: Literal["csv", "nmea", "rtklib", "sbet", "novatel", "sbg", "vectornav", "xsens"]
    """What the file is. Takes one of "csv", "nmea", "rtklib", "sbet", "novatel", "sbg", "vectornav", "xsens".
    Default: by the name's ending: nmea and nma; pos; sbet and out; others are columns of text."""
    heading: int | str
    """Heading from north by east. Takes a column number from 1, or a column's name. Default: the name of
    Octant's exports, where the header has it."""
    heading_rate: str
    """NMEA: even rate of headings in a file without any time. Sentences that are missing can't be seen. Takes a
    frequency such as "200 Hz". Left out: they have times."""
    heading_start: str
    """NMEA: time of the first heading of heading_rate, such as 2027-03-31T08:00:00Z. Takes a text in quotes.
    Left out: 0 s on a scale of its own."""
    heading_time: Literal["tag", "stamp", "cycle"]
    """NMEA: time of headings without one, such as HDT and THS. Takes one of "tag", "stamp", "cycle". Default:
    the first of tag, stamp and cycle that the file has."""
    height: int | str
    """Height above the ellipsoid, m. Takes a column number from 1, or a column's name. Default: the name of
    Octant's exports, where the header has it."""
    latitude: int | str
    """Geodetic latitude. Takes a column number from 1, or a column's name. Default: the name of Octant's
    exports, where the header has it."""
    longitude: int | str
    """Longitude, east of Greenwich. Takes a column number from 1, or a column's name. Default: the name of
    Octant's exports, where the header has it."""
    north: int | str
    """Velocity over ground, north. Takes a column number from 1, or a column's name. Default: the name of
    Octant's exports, where the header has it."""
    pitch: int | str
    """Pitch, positive with the bow up. Takes a column number from 1, or a column's name. Default: the name of
    Octant's exports, where the header has it."""
    points: Literal["positions", "headings"]
    """NMEA: sentences that make a point each. Takes one of "positions", "headings". Default: headings, where the
    reference is true_heading or the file has no position; else positions."""
    roll: int | str
    """Roll, positive with the starboard side down. Takes a column number from 1, or a column's name. Default:
    the name of Octant's exports, where the header has it."""
    skip: str
    """Time at its beginning that isn't scored, such as an alignment. Takes a time such as "12 h". Default: "0
    s"."""
    skip_lines: int
    """Columns of text: lines to skip at the start. Takes a whole number from 0 to 1000000. Default: 0."""
    talker: str
    """NMEA: letters of the talker whose sentences count, such as IN; dates count from all. PASHR has no talker,
    and always counts. Takes a text in quotes. Left out: all talkers, which have to agree."""
    time_column: int | str
    """Time of each row, in time_unit, or as 2027-03-31T08:00:00.5Z: its column, a name in the header or a number
    from 1. Takes a column number from 1, or a column's name. Default: the name of Octant's exports, where the
    header has it."""
    time_unit: Literal["s", "ms", "us", "ns"]
    """Unit of a time that is a number. Takes one of "s", "ms", "us", "ns". Default: "s"."""
    velocity_unit: Literal["m/s", "kn", "mm/s"]
    """Unit of the columns of velocities. Takes one of "m/s", "kn", "mm/s". Default: "m/s"."""

class SourceTextAccelerometer(Section):
    """Columns of the accelerometers. Takes a table with file, x, y, z, unit, quantity, scale, offset, axes."""

    axes: Sequence[Literal["x", "-x", "y", "-y", "z", "-z"]]
    """Which instrument axis, with its sign, lies along body x, y and z. Takes a list of some of x, -x, y, -y, z,
    -z. Default: ["x", "y", "z"]."""
    file: str
    """File of these columns, where it isn't that of source.uri. Takes a text in quotes. Left out: the file of
    source.uri."""
    offset: Sequence[float]
    """Raw number of zero, x, y, z. Takes 3 numbers. Default: [0.0, 0.0, 0.0]."""
    quantity: Literal["rate", "increment"]
    """Specific force or increments. Takes one of "rate", "increment". Default: "rate"."""
    scale: Sequence[float]
    """Unit per raw number, x, y, z, before axes are exchanged: value = (raw − offset) · scale. Takes 3 numbers.
    Default: [1.0, 1.0, 1.0]."""
    unit: Literal["m/s^2", "g", "mg", "m/s", "mm/s"]
    """Unit after scaling: of specific force, or of a velocity for increments. Takes one of "m/s^2", "g", "mg",
    "m/s", "mm/s". Default: "m/s^2"."""
    x: int | str
    """Column of x: its number from 1, or its name. Takes a column number from 1, or a column's name."""
    y: int | str
    """Column of y. Takes a column number from 1, or a column's name."""
    z: int | str
    """Column of z. Takes a column number from 1, or a column's name."""

class SourceTextGimbal(Section):
    """Columns of the gimbal angles, in the gyro's file. Takes a table with azimuth, roll, unit. Left out: no
    gimbals: their angles are flagged invalid."""

    azimuth: int | str
    """Column of the inner gimbal. Takes a column number from 1, or a column's name."""
    roll: int | str
    """Column of the outer gimbal. Takes a column number from 1, or a column's name."""
    unit: Literal["deg", "rad", "arcsec"]
    """Unit of both. Takes one of "deg", "rad", "arcsec". Default: "deg"."""

class SourceTextGyro(Section):
    """Columns of the gyros. Takes a table with file, x, y, z, unit, quantity, scale, offset, axes."""

    axes: Sequence[Literal["x", "-x", "y", "-y", "z", "-z"]]
    """Which instrument axis, with its sign, lies along body x, y and z. Takes a list of some of x, -x, y, -y, z,
    -z. Default: ["x", "y", "z"]."""
    file: str
    """File of these columns, where it isn't that of source.uri. Takes a text in quotes. Left out: the file of
    source.uri."""
    offset: Sequence[float]
    """Raw number of zero, x, y, z. Takes 3 numbers. Default: [0.0, 0.0, 0.0]."""
    quantity: Literal["rate", "increment"]
    """Rates or increments. Takes one of "rate", "increment". Default: "rate"."""
    scale: Sequence[float]
    """Unit per raw number, x, y, z, before axes are exchanged: value = (raw − offset) · scale. Takes 3 numbers.
    Default: [1.0, 1.0, 1.0]."""
    unit: Literal["rad/s", "deg/s", "deg/h", "rad", "deg", "arcsec"]
    """Unit after scaling: of a rate, or of an angle for increments. Takes one of "rad/s", "deg/s", "deg/h",
    "rad", "deg", "arcsec". Default: "rad/s"."""
    x: int | str
    """Column of x: its number from 1, or its name. Takes a column number from 1, or a column's name."""
    y: int | str
    """Column of y. Takes a column number from 1, or a column's name."""
    z: int | str
    """Column of z. Takes a column number from 1, or a column's name."""

class SourceText(Section):
    """How the text files are read. Takes a table with rate, split, delimiter, skip_lines, header, comment,
    time_column, time_unit, temperature_column, temperature_unit, gyro, accelerometer, gimbal. Default: needed
    by text:FILE."""

    @property
    def accelerometer(self) -> SourceTextAccelerometer:
        """Columns of the accelerometers. Takes a table with file, x, y, z, unit, quantity, scale, offset, axes."""
    @accelerometer.setter
    def accelerometer(self, value: SourceTextAccelerometer | Mapping[str, Any]) -> None: ...
    comment: str
    """Lines that start with this are skipped. Takes a text in quotes. Default: "#"."""
    delimiter: Literal["whitespace", "comma", "semicolon", "tab"]
    """What separates columns. Takes one of "whitespace", "comma", "semicolon", "tab". Default: "whitespace"."""
    @property
    def gimbal(self) -> SourceTextGimbal:
        """Columns of the gimbal angles, in the gyro's file. Takes a table with azimuth, roll, unit. Left out: no
        gimbals: their angles are flagged invalid."""
    @gimbal.setter
    def gimbal(self, value: SourceTextGimbal | Mapping[str, Any]) -> None: ...
    @property
    def gyro(self) -> SourceTextGyro:
        """Columns of the gyros. Takes a table with file, x, y, z, unit, quantity, scale, offset, axes."""
    @gyro.setter
    def gyro(self, value: SourceTextGyro | Mapping[str, Any]) -> None: ...
    header: bool
    """Whether the first line after those skipped names the columns. Takes true or false. Default: false."""
    rate: str
    """Nominal rate of the rows: times split, it is imu.rate. Takes a frequency such as "200 Hz". Default:
    imu.rate divided by split."""
    skip_lines: int
    """Lines to skip at the start. Takes a whole number from 0 to 1000000. Default: 0."""
    split: int
    """Samples that a row or message becomes, equal parts of its interval, so that counts hold faster rates (179
    deg/s at 100 Hz, 358 deg/s at 200 Hz). Takes a whole number from 1 to 1000. Default: 1."""
    temperature_column: int | str
    """Column of the instrument's temperature, in the gyro's file; octant characterise reads it. Takes a column
    number from 1, or a column's name. Left out: the file has no temperature."""
    temperature_unit: Literal["degC", "K"]
    """Unit of the temperature. Takes one of "degC", "K". Default: "degC"."""
    time_column: int | str
    """Column of the time stamp, in time_unit or such as 2027-03-31T08:00:00.5Z; "none": rows without one, which
    follow each other at the nominal rate. Takes a column number from 1, or a column's name. Default: 1."""
    time_unit: Literal["s", "ms", "us", "ns"]
    """Unit of the time stamp. Takes one of "s", "ms", "us", "ns". Default: "s"."""

class SourceTrajectory(Section):
    """The reference trajectory that a solution is scored against. Takes a table with file, true_heading,
    true_heading_uncertainty, offset, offset_uncertainty, gap, format, talker, points, heading_time,
    heading_rate, heading_start, delimiter, skip_lines, comment, time_column, time_unit, latitude, longitude,
    height, north, east, heading, pitch, roll, angle_unit, velocity_unit. Left out: needed by solution:FILE."""

    angle_unit: Literal["deg", "rad"]
    """Unit of the columns of angles: position and attitude. Takes one of "deg", "rad". Default: "deg"."""
    comment: str
    """Columns of text: lines that start with this are skipped. Takes a text in quotes. Default: "#"."""
    delimiter: Literal["whitespace", "comma", "semicolon", "tab"]
    """Columns of text: what separates them. Takes one of "whitespace", "comma", "semicolon", "tab". Default:
    "comma"."""
    east: int | str
    """Velocity over ground, east. Takes a column number from 1, or a column's name. Default: the name of
    Octant's exports, where the header has it."""
    file: str
    """Its file. Relative to the scenario. Takes a text in quotes. Left out: true_heading is the reference."""
    format: Literal["csv", "nmea", "rtklib", "sbet", "novatel", "sbg", "vectornav", "xsens"]
    """What the file is. Takes one of "csv", "nmea", "rtklib", "sbet", "novatel", "sbg", "vectornav", "xsens".
    Default: by the name's ending: nmea and nma; pos; sbet and out; others are columns of text."""
    gap: str
    """Rows further apart than this have a gap between them, in which nothing is scored. Takes a time such as "12
    h". Default: "2 s"."""
    heading: int | str
    """Heading from north by east. Takes a column number from 1, or a column's name. Default: the name of
    Octant's exports, where the header has it."""
    heading_rate: str
    """NMEA: even rate of headings in a file without any time. Sentences that are missing can't be seen. Takes a
    frequency such as "200 Hz". Left out: they have times."""
    heading_start: str
    """NMEA: time of the first heading of heading_rate, such as 2027-03-31T08:00:00Z. Takes a text in quotes.
    Left out: 0 s on a scale of its own."""
    heading_time: Literal["tag", "stamp", "cycle"]
    """NMEA: time of headings without one, such as HDT and THS. Takes one of "tag", "stamp", "cycle". Default:
    the first of tag, stamp and cycle that the file has."""
    height: int | str
    """Height above the ellipsoid, m. Takes a column number from 1, or a column's name. Default: the name of
    Octant's exports, where the header has it."""
    latitude: int | str
    """Geodetic latitude. Takes a column number from 1, or a column's name. Default: the name of Octant's
    exports, where the header has it."""
    longitude: int | str
    """Longitude, east of Greenwich. Takes a column number from 1, or a column's name. Default: the name of
    Octant's exports, where the header has it."""
    north: int | str
    """Velocity over ground, north. Takes a column number from 1, or a column's name. Default: the name of
    Octant's exports, where the header has it."""
    offset: str
    """What is added to the solution's times to get those of this file. Takes a time such as "12 h". Left out: 0
    s, if both files tell the time on a scale that is known; else it has to be given."""
    offset_uncertainty: str
    """How far that may be wrong, 95 %: what moves by it is in doubt, and so are the verdicts. Takes a time such
    as "12 h". Default: "0 s"."""
    pitch: int | str
    """Pitch, positive with the bow up. Takes a column number from 1, or a column's name. Default: the name of
    Octant's exports, where the header has it."""
    points: Literal["positions", "headings"]
    """NMEA: sentences that make a point each. Takes one of "positions", "headings". Default: headings, where the
    reference is true_heading or the file has no position; else positions."""
    roll: int | str
    """Roll, positive with the starboard side down. Takes a column number from 1, or a column's name. Default:
    the name of Octant's exports, where the header has it."""
    skip_lines: int
    """Columns of text: lines to skip at the start. Takes a whole number from 0 to 1000000. Default: 0."""
    talker: str
    """NMEA: letters of the talker whose sentences count, such as IN; dates count from all. PASHR has no talker,
    and always counts. Takes a text in quotes. Left out: all talkers, which have to agree."""
    time_column: int | str
    """Time of each row, in time_unit, or as 2027-03-31T08:00:00.5Z: its column, a name in the header or a number
    from 1. Takes a column number from 1, or a column's name. Default: the name of Octant's exports, where the
    header has it."""
    time_unit: Literal["s", "ms", "us", "ns"]
    """Unit of a time that is a number. Takes one of "s", "ms", "us", "ns". Default: "s"."""
    true_heading: str
    """Heading that was surveyed, as by a theodolite, of an instrument that stands still: it is the reference,
    instead of a file. Takes an angle such as "30.5 deg". Left out: the reference is a file."""
    true_heading_uncertainty: str
    """How far true_heading may be off, 95 %. Takes an angle such as "30.5 deg". Left out: that of [decision]."""
    velocity_unit: Literal["m/s", "kn", "mm/s"]
    """Unit of the columns of velocities. Takes one of "m/s", "kn", "mm/s". Default: "m/s"."""

class Source(Section):
    """Where the samples come from. Takes a table with uri, text, mcap, fmu, reference, solution, trajectory,
    dither, live, log."""

    dither: float
    """Noise that the harness adds to the samples of an instrument whose own noise isn't known, from the seed, in
    parts of imu.angle_random_walk and imu.velocity_random_walk: shows whether the unit follows its samples.
    Their noise grows by the root of 1 + dither². Takes a number between 0.05 and 1. Left out: nothing is
    added."""
    @property
    def fmu(self) -> SourceFmu:
        """How the FMU of source.uri is run, and what its variables are. Takes a table with interface, process,
        time_limit, allow_tool, step, tolerance, parameters, map. Default: fmu: the defaults of its keys."""
    @fmu.setter
    def fmu(self, value: SourceFmu | Mapping[str, Any]) -> None: ...
    @property
    def live(self) -> SourceLive:
        """What the instrument of source.uri speaks, and how it is mounted. Takes a table with protocol,
        database, mapping, description, axes, gyro_count, accel_count, silence, pps, pps_edge, pps_silence,
        stamps, stamps_within, host_clock, host_within, tai_offset. Default: serial, udp, tcp, can and slcan:
        the defaults of its keys."""
    @live.setter
    def live(self, value: SourceLive | Mapping[str, Any]) -> None: ...
    @property
    def log(self) -> SourceLog:
        """What the instrument spoke whose bytes source.uri names, and how it was mounted. Takes a table with
        protocol, description, axes, gyro_count, accel_count. Default: needed by log:FILE."""
    @log.setter
    def log(self, value: SourceLog | Mapping[str, Any]) -> None: ...
    @property
    def mcap(self) -> SourceMcap:
        """Which channels and fields of another program's MCAP file are read. Takes a table with topic,
        time_field, nanoseconds_field, time_unit, temperature_field, temperature_unit, rate, split, gyro,
        accelerometer. Default: replay: the channels that this program writes."""
    @mcap.setter
    def mcap(self, value: SourceMcap | Mapping[str, Any]) -> None: ...
    @property
    def reference(self) -> SourceReference:
        """The reference of a calibration, where the source brings none: what is known of the motion of text,
        another program's MCAP file or an instrument on a port, or what was measured and recorded beside the
        samples. Takes a table with kind, north, east, down, up, latitude, longitude, height, unit, file,
        delimiter, skip_lines, header, comment, time_column, topic, time_field, nanoseconds_field, time_unit.
        Left out: the source brings its own, or there is none."""
    @reference.setter
    def reference(self, value: SourceReference | Mapping[str, Any]) -> None: ...
    @property
    def solution(self) -> SourceSolution:
        """How the solution of source.uri is read. Takes a table with skip, format, talker, points, heading_time,
        heading_rate, heading_start, delimiter, skip_lines, comment, time_column, time_unit, latitude,
        longitude, height, north, east, heading, pitch, roll, angle_unit, velocity_unit. Default: solution:
        the defaults of its keys."""
    @solution.setter
    def solution(self, value: SourceSolution | Mapping[str, Any]) -> None: ...
    @property
    def text(self) -> SourceText:
        """How the text files are read. Takes a table with rate, split, delimiter, skip_lines, header, comment,
        time_column, time_unit, temperature_column, temperature_unit, gyro, accelerometer, gimbal. Default:
        needed by text:FILE."""
    @text.setter
    def text(self, value: SourceText | Mapping[str, Any]) -> None: ...
    @property
    def trajectory(self) -> SourceTrajectory:
        """The reference trajectory that a solution is scored against. Takes a table with file, true_heading,
        true_heading_uncertainty, offset, offset_uncertainty, gap, format, talker, points, heading_time,
        heading_rate, heading_start, delimiter, skip_lines, comment, time_column, time_unit, latitude,
        longitude, height, north, east, heading, pitch, roll, angle_unit, velocity_unit. Left out: needed by
        solution:FILE."""
    @trajectory.setter
    def trajectory(self, value: SourceTrajectory | Mapping[str, Any]) -> None: ...
    uri: str
    """Where samples come from. A file name is relative to the scenario, and may start with ${OCTANT_RECORDINGS}.
    Takes one of "plant", "replay", "text", "solution", "log", "fmu", "serial", "udp", "tcp", "can", "slcan".
    Default: "plant"."""

class TurntableDrawnEccentricity(Section):
    """Eccentricity of the encoders: cosine and sine of azimuth and of roll, four. Takes a table with one of
    normal, uniform. Left out: as given."""

    normal: str
    """Drawn from a normal distribution of this standard deviation, each entry alone. Takes an angle such as "40
    arcsec". Left out: another is given."""
    uniform: str
    """Drawn evenly within plus and minus this half width, each entry alone. Takes an angle such as "40 arcsec".
    Left out: another is given."""

class TurntableDrawnMounting(Section):
    """Mounting of the body on the inner gimbal, three. Takes a table with one of normal, uniform. Left out: as
    given."""

    normal: str
    """Drawn from a normal distribution of this standard deviation, each entry alone. Takes an angle such as "40
    arcsec". Left out: another is given."""
    uniform: str
    """Drawn evenly within plus and minus this half width, each entry alone. Takes an angle such as "40 arcsec".
    Left out: another is given."""

class TurntableDrawnNonOrthogonality(Section):
    """Angle by which the gimbal axes miss a right angle, one. Takes a table with one of normal, uniform. Left
    out: as given."""

    normal: str
    """Drawn from a normal distribution of this standard deviation, each entry alone. Takes an angle such as "40
    arcsec". Left out: another is given."""
    uniform: str
    """Drawn evenly within plus and minus this half width, each entry alone. Takes an angle such as "40 arcsec".
    Left out: another is given."""

class TurntableDrawn(Section):
    """Errors of the gimbals that the seed draws, each group from its own stream; they add to the values given
    above. Takes a table with mounting, non_orthogonality, eccentricity. Left out: nothing is drawn."""

    @property
    def eccentricity(self) -> TurntableDrawnEccentricity:
        """Eccentricity of the encoders: cosine and sine of azimuth and of roll, four. Takes a table with one of
        normal, uniform. Left out: as given."""
    @eccentricity.setter
    def eccentricity(self, value: TurntableDrawnEccentricity | Mapping[str, Any]) -> None: ...
    @property
    def mounting(self) -> TurntableDrawnMounting:
        """Mounting of the body on the inner gimbal, three. Takes a table with one of normal, uniform. Left out:
        as given."""
    @mounting.setter
    def mounting(self, value: TurntableDrawnMounting | Mapping[str, Any]) -> None: ...
    @property
    def non_orthogonality(self) -> TurntableDrawnNonOrthogonality:
        """Angle by which the gimbal axes miss a right angle, one. Takes a table with one of normal, uniform.
        Left out: as given."""
    @non_orthogonality.setter
    def non_orthogonality(self, value: TurntableDrawnNonOrthogonality | Mapping[str, Any]) -> None: ...

class TurntableDrive(Section):
    """A real table that the core's set points turn, under a real instrument. It can hurt people: read
    docs/turntable.md first. Takes a table with port, dialect, driver, units, azimuth, roll, home, start,
    tolerance, look, oldest, reply, guard, watchdog. Left out: no table is turned: the gimbals are those of
    the source."""

    azimuth: Sequence[str]
    """Least and greatest angle to which azimuth may turn. How fast both may turn is turntable.rate and
    turntable.acceleration. Takes an array of 2, each an angle such as "30.5 deg"."""
    dialect: str
    """What the controller speaks: aerotech-ensemble, or a file with a table of patterns. Takes a text in quotes.
    Default: "aerotech-ensemble"."""
    driver: Literal["this run", "another run"]
    """Which run drives the table. Takes one of "this run", "another run". Default: "this run"."""
    guard: str
    """Silence of the program after which a process of its own stops the table. 0 s: there is none. Takes a time
    such as "12 h". Default: where the system has guards: "1 s"; elsewhere: "0 s"."""
    home: bool
    """Whether both axes find their reference before the run. Takes true or false. Default: false."""
    look: str
    """Pause from one look at the table to the next; set points are told with a look. Takes a time such as "12
    h". Default: "20 ms"."""
    oldest: str
    """How far a sample may be from the nearest look and still get its gimbal angles; beyond it they are flagged
    invalid. Takes a time such as "12 h". Default: "100 ms"."""
    port: str
    """Port of its controller: tcp:HOST:PORT, or serial:DEVICE?baud=RATE (115200 by default). Takes a text in
    quotes."""
    reply: str
    """How long a reply of the controller is waited for; then the table is stopped. Takes a time such as "12 h".
    Default: "500 ms"."""
    roll: Sequence[str]
    """Least and greatest angle to which roll may turn. Takes an array of 2, each an angle such as "30.5 deg"."""
    start: str
    """How long homing may take, and the way to zero, where every run begins. Takes a time such as "12 h".
    Default: "2 min"."""
    tolerance: str
    """How far from zero a gimbal may rest at the start. Takes an angle such as "40 arcsec". Default: "36
    arcsec"."""
    units: int
    """Number of runs on the table, this one included: all begin together. Takes a whole number from 1 to 64.
    Default: 1."""
    watchdog: str
    """Silence after which the controller stops the table by itself. 0 s: it isn't told to. Takes a time such as
    "12 h". Default: "0 s"."""

class Turntable(Section):
    """The two gimbals. Takes a table with rate, acceleration, encoder_error, non_orthogonality, mounting,
    encoder_zero, eccentricity_azimuth, eccentricity_roll, encoder_noise, drawn, backlash, drive."""

    acceleration: str
    """Acceleration of a move. Takes an angular acceleration such as "10 deg/s^2". Default: "10 deg/s^2"."""
    backlash: str
    """Play of each gear. Takes an angle such as "40 arcsec". Default: "0 arcsec"."""
    @property
    def drawn(self) -> TurntableDrawn:
        """Errors of the gimbals that the seed draws, each group from its own stream; they add to the values
        given above. Takes a table with mounting, non_orthogonality, eccentricity. Left out: nothing is drawn."""
    @drawn.setter
    def drawn(self, value: TurntableDrawn | Mapping[str, Any]) -> None: ...
    @property
    def drive(self) -> TurntableDrive:
        """A real table that the core's set points turn, under a real instrument. It can hurt people: read
        docs/turntable.md first. Takes a table with port, dialect, driver, units, azimuth, roll, home, start,
        tolerance, look, oldest, reply, guard, watchdog. Left out: no table is turned: the gimbals are those
        of the source."""
    @drive.setter
    def drive(self, value: TurntableDrive | Mapping[str, Any]) -> None: ...
    eccentricity_azimuth: Sequence[str]
    """Coefficients c and s of the azimuth encoder's error c cos(angle) + s sin(angle), beside encoder_error.
    Takes an array of 2, each an angle such as "40 arcsec". Default: ["0 arcsec", "0 arcsec"]."""
    eccentricity_roll: Sequence[str]
    """The same of the roll encoder. Takes an array of 2, each an angle such as "40 arcsec". Default: ["0
    arcsec", "0 arcsec"]."""
    encoder_error: str
    """Error of the angle encoders, one standard deviation: a fixed curve over the angle. Takes an angle such as
    "40 arcsec". Default: "18 arcsec"."""
    encoder_noise: str
    """White noise of each encoder's readings, one standard deviation. Takes an angle such as "40 arcsec".
    Default: "0 arcsec"."""
    encoder_zero: Sequence[str]
    """Zero errors of the encoders of azimuth and roll: measured minus true. Takes an array of 2, each an angle
    such as "40 arcsec". Default: ["0 arcsec", "0 arcsec"]."""
    mounting: Sequence[str]
    """Turn of the body on the inner gimbal about its x, y and z. Takes an array of 3, each an angle such as "40
    arcsec". Default: ["0 arcsec", "0 arcsec", "0 arcsec"]."""
    non_orthogonality: str
    """Angle by which the two gimbal axes miss a right angle. Takes an angle such as "40 arcsec". Default: "0
    arcsec"."""
    rate: str
    """Largest rate of a move. Takes an angular rate such as "10 deg/s". Default: "10 deg/s"."""

class Scenario(Section):
    """A scenario: what ``octant run`` reads from a TOML file."""

    @property
    def baseline(self) -> Baseline:
        """A second method, run on the same seed and noise and compared: what it does differently. Takes a table
        with positions, stops, name, passes, estimator, error_model, g_states, not_estimated, further. Left
        out: no second method."""
    @baseline.setter
    def baseline(self, value: Baseline | Mapping[str, Any]) -> None: ...
    @property
    def decision(self) -> Decision:
        """What a value near its limit comes to, by how uncertain its reference is. Takes a table with rule,
        position, uncertainties."""
    @decision.setter
    def decision(self, value: Decision | Mapping[str, Any]) -> None: ...
    @property
    def display(self) -> Display:
        """Units of errors in report and terminal. Files for machines keep theirs. Takes a table with position,
        attitude, velocity."""
    @display.setter
    def display(self, value: Display | Mapping[str, Any]) -> None: ...
    @property
    def endpoint(self) -> Endpoint:
        """Where the core runs. Takes a table with uri, fmu, link."""
    @endpoint.setter
    def endpoint(self, value: Endpoint | Mapping[str, Any]) -> None: ...
    equipment: Sequence[Mapping[str, Any]]
    """Equipment of the bench with its certificates. One that has expired makes a run inconclusive. Takes an
    array of tables with name, serial, certificate, expires. Left out: nothing is told of the bench."""
    faults: Sequence[Mapping[str, Any]]
    """Faults that are injected on the way from the instrument to the core, in the order in which they act.
    Beside the keys that all have there are those of the kind: `octant faults list` names all kinds, `octant
    faults describe KIND` tells what one does and takes. Takes an array of tables. Left out: no fault is
    injected."""
    @property
    def imu(self) -> Imu:
        """The sensors and their true errors. Takes a table with model, rate, angle_random_walk,
        velocity_random_walk, gyro_bias, gyro_scale, gyro_misalignment, g_dependent, accel_bias, accel_scale,
        accel_misalignment, extensions."""
    @imu.setter
    def imu(self, value: Imu | Mapping[str, Any]) -> None: ...
    @property
    def motion(self) -> Motion:
        """How the case of the instrument moves. Takes a table with kind, heading, pitch, roll, ship."""
    @motion.setter
    def motion(self, value: Motion | Mapping[str, Any]) -> None: ...
    operator: Sequence[Mapping[str, Any]]
    """What a person at the bench does in the run, and is asked. Takes an array of tables with id, ask, trigger,
    answer, unit, least, most, choices, on_no, timeout, on_timeout, who, hold. Left out: nobody is asked."""
    @property
    def power(self) -> Power:
        """The supply or the relay that feeds the device of the endpoint, over SCPI. Takes a table with port,
        channel, relay, voltage, current_limit, tolerance, settle, rest, lead, reply, remote, end. Left out:
        nothing is switched."""
    @power.setter
    def power(self, value: Power | Mapping[str, Any]) -> None: ...
    @property
    def procedure(self) -> Procedure:
        """What the core does: align, calibrate, navigate. Takes a table with alignment, calibration, navigation,
        heading_test, initial_parameters."""
    @procedure.setter
    def procedure(self, value: Procedure | Mapping[str, Any]) -> None: ...
    @property
    def realtime(self) -> Realtime:
        """Whether the run goes by the clock, how, and what makes it too late. Takes a table with pace, overrun,
        overruns, lateness_p99, late_answers, silence, priority, cpu, lock_memory, spin."""
    @realtime.setter
    def realtime(self, value: Realtime | Mapping[str, Any]) -> None: ...
    @property
    def record(self) -> Record:
        """What is recorded, and how often. Takes a table with rate, samples, parameters, topics, topics_period."""
    @record.setter
    def record(self, value: Record | Mapping[str, Any]) -> None: ...
    requirements: Sequence[Mapping[str, Any]]
    """Limits that the results have to keep. Takes an array of tables with id, text, measure, limit, comparison,
    secant_latitude, clause. Left out: no requirement is checked."""
    @property
    def screening(self) -> Screening:
        """Screens and gates of the core. Takes a table with gate, stuck_samples, jumps, bridging, gimbals,
        drift, checkpoints, aiding_stamps."""
    @screening.setter
    def screening(self, value: Screening | Mapping[str, Any]) -> None: ...
    seed: int
    """Seed of every random draw: the same seed gives the same bytes. Takes a whole number of 0 or more. Default:
    1."""
    @property
    def site(self) -> Site:
        """Where the instrument stands. Takes a table with latitude, longitude, height, deflection_north,
        deflection_east, gravity_anomaly, drawn."""
    @site.setter
    def site(self, value: Site | Mapping[str, Any]) -> None: ...
    @property
    def source(self) -> Source:
        """Where the samples come from. Takes a table with uri, text, mcap, fmu, reference, solution, trajectory,
        dither, live, log."""
    @source.setter
    def source(self, value: Source | Mapping[str, Any]) -> None: ...
    title: str
    """What the run is about, in a line. Takes a text in quotes. Default: "untitled"."""
    @property
    def turntable(self) -> Turntable:
        """The two gimbals. Takes a table with rate, acceleration, encoder_error, non_orthogonality, mounting,
        encoder_zero, eccentricity_azimuth, eccentricity_roll, encoder_noise, drawn, backlash, drive."""
    @turntable.setter
    def turntable(self, value: Turntable | Mapping[str, Any]) -> None: ...

    def __init__(self, keys: Mapping[str, Any] | None = None, path: PathLike = "scenario.toml") -> None: ...
    @classmethod
    def load(cls, path: PathLike) -> Scenario:
        """Read a TOML file."""
    @classmethod
    def from_toml(cls, text: str, path: PathLike = "scenario.toml") -> Scenario:
        """Read TOML; ``path`` is where relative names of files start."""
    def to_toml(self) -> str:
        """Write the scenario as TOML."""
    def save(self, path: PathLike) -> None:
        """Write the scenario into a TOML file."""
    def check(self) -> Scenario:
        """Check every key and value, and return the scenario."""
    def copy(self) -> Scenario:
        """Return a copy that can be changed by itself."""
    @staticmethod
    def schema() -> dict[str, Any]:
        """JSON Schema of scenarios."""
