; The magnitude is kept.
(assert (= defined_f defined_a))
(assert (= f (size a)))
(assert (= defined_g defined_a2))
(assert (= g (size a2)))
(assert (fits defined_a a defined_a2 a2 (most t 0.0) (most t 0.0)))
(assert (not (fits defined_f f defined_g g s t)))
