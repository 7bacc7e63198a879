; The negative swaps thresholds.
(assert (= defined_f defined_a))
(assert (= f (- a)))
(assert (= defined_g defined_a2))
(assert (= g (- a2)))
(assert (fits defined_a a defined_a2 a2 t s))
(assert (not (fits defined_f f defined_g g s t)))
