; Thresholds of a magnitude's operand that do not hold on both sides.
(assert (= defined_f defined_a))
(assert (= f (size a)))
(assert (= defined_g defined_a2))
(assert (= g (size a2)))
(assert (fits defined_a a defined_a2 a2 s t))
(assert (not (fits defined_f f defined_g g s t)))
