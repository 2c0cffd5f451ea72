# SPDX-License-Identifier: Apache-2.0
"""An FMU of pythonfmu with all types of FMI 2.0 except enumerations."""

from pythonfmu import Boolean, Fmi2Causality, Fmi2Slave, Fmi2Variability, Integer, Real, String


class PythonSlave(Fmi2Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.gain = 2.0
        self.u = 0.0
        self.count_in = 0
        self.flag_in = False
        self.word_in = "nothing"
        self.y = 0.0
        self.area = 0.0
        self.count = 0
        self.flag = True
        self.word = ""
        self.register_variable(
            Real("gain", causality=Fmi2Causality.parameter, variability=Fmi2Variability.tunable)
        )
        self.register_variable(Real("u", causality=Fmi2Causality.input))
        self.register_variable(Integer("count_in", causality=Fmi2Causality.input))
        self.register_variable(Boolean("flag_in", causality=Fmi2Causality.input))
        self.register_variable(String("word_in", causality=Fmi2Causality.input))
        self.register_variable(Real("y", causality=Fmi2Causality.output))
        self.register_variable(Real("area", causality=Fmi2Causality.output))
        self.register_variable(Integer("count", causality=Fmi2Causality.output))
        self.register_variable(Boolean("flag", causality=Fmi2Causality.output))
        self.register_variable(String("word", causality=Fmi2Causality.output))

    def do_step(self, current_time, step_size):
        self.area += self.u * step_size
        self.y = self.gain * self.u + current_time
        self.count = self.count_in + 1
        self.flag = not self.flag_in
        self.word = f"{self.word_in[:8]}ä{self.count}"
        return True
