"""An FMU in Python, for PythonFMU: it adds up its input over time."""

from pythonfmu import Fmi2Causality, Fmi2Slave, Real


class Adder(Fmi2Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.u = 1.0
        self.sum = 0.0
        self.register_variable(Real("u", causality=Fmi2Causality.input))
        self.register_variable(Real("sum", causality=Fmi2Causality.output))

    def do_step(self, current_time, step_size):
        self.sum += self.u * step_size
        return True
