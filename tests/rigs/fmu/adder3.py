"""An FMU of PythonFMU3: y is x and one."""

from pythonfmu3 import Float64, Fmi3Causality, Fmi3Slave, Fmi3Variability


class Adder3(Fmi3Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.time, self.x, self.y = 0.0, 0.0, 0.0
        continuous = Fmi3Variability.continuous
        self.register_variable(Float64("time", causality=Fmi3Causality.independent, variability=continuous))
        self.register_variable(Float64("x", causality=Fmi3Causality.input, start=0.0))
        self.register_variable(Float64("y", causality=Fmi3Causality.output))

    def do_step(self, current_time, step_size):
        self.y = self.x + 1.0
        return True
