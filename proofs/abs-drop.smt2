; The operand replaces its magnitude: it is nowhere below 0.
(assert (= defined_f defined_a))
(assert (= f (size a)))
(assert (= defined_g defined_a2))
(assert (= g a2))
(assert (>= lo_a 0.0))
(assert (fits defined_a a defined_a2 a2 s t))
(assert (not (fits defined_f f defined_g g s t)))
