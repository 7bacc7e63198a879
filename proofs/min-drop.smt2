; An operand of a minimum is dropped: it has a value, and is beyond t.
(assert (= defined_f (and defined_a defined_b)))
(assert (= defined_g defined_a2))
(assert (= g a2))
(assert (= f (least a b)))
(assert defined_b)
(assert (> lo_b t))
(assert (fits defined_a a defined_a2 a2 s t))
(assert (not (fits defined_f f defined_g g s t)))
