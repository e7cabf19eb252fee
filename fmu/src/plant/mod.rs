//! Motion, turntable, sensors and faults as a component.
