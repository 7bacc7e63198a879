; A choice is kept. Only the sign of its condition matters.
(assert (= defined_f (and defined_q (ite (< q 0.0) defined_a defined_b))))
(assert (= f (ite (< q 0.0) a b)))
(assert (= defined_g (and defined_q2 (ite (< q2 0.0) defined_a2 defined_b2))))
(assert (= g (ite (< q2 0.0) a2 b2)))
(assert (fits defined_q q defined_q2 q2 0.0 0.0))
(assert (fits defined_a a defined_a2 a2 s t))
(assert (fits defined_b b defined_b2 b2 s t))
(assert (not (fits defined_f f defined_g g s t)))
