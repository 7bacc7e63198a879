; The condition has a value throughout, below 0.
(assert (= defined_f (and defined_q (ite (< q 0.0) defined_a defined_b))))
(assert (= f (ite (< q 0.0) a b)))
(assert (= defined_g defined_a2))
(assert (= g a2))
(assert defined_q)
(assert (< q 0.0))
(assert (fits defined_a a defined_a2 a2 s t))
(assert (not (fits defined_f f defined_g g s t)))
