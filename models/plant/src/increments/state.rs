//! The moving body as bytes, and back.

use super::Body;

impl octant_state::State for Body {
    fn save(&self, to: &mut octant_state::Writer) {
        let Self {
            period_ns: _,
            period_s: _,
            piece_s: _,
            nodes: _,
            case,
            azimuth,
            roll,
            azimuth_near,
            roll_near,
            tilt_sincos: _,
            mounting: _,
            vibration: _,
            lever_arm,
            own_lever_arm: _,
            rate_at_end,
            lag,
            constant: _,
            resting_sincos: _,
            registry,
            active,
        } = self;
        to.part("case", case);
        to.part("azimuth", azimuth);
        to.part("roll", roll);
        to.value("near", &(azimuth_near, roll_near));
        to.value("lever_arm", lever_arm);
        to.value("rate_at_end", rate_at_end);
        to.part("lag", lag);
        to.value("registry", registry);
        to.value("active", active);
    }

    fn load(
        &mut self,
        from: &mut octant_state::StateReader<'_>,
    ) -> Result<(), octant_state::StateError> {
        from.part("case", &mut self.case)?;
        from.part("azimuth", &mut self.azimuth)?;
        from.part("roll", &mut self.roll)?;
        (self.azimuth_near, self.roll_near) = from.value("near")?;
        self.lever_arm = from.value("lever_arm")?;
        self.rate_at_end = from.value("rate_at_end")?;
        from.part("lag", &mut self.lag)?;
        self.registry = from.value("registry")?;
        self.active = from.value("active")?;
        self.look_again();
        if self.active.is_some() {
            // The piece length follows from the active motions and isn't saved.
            self.plan();
        }
        Ok(())
    }
}
