; A substitute for wider thresholds serves for narrower ones.
(declare-const s2 Real) (declare-const t2 Real)
(assert (<= s s2))
(assert (<= t t2))
(assert (fits defined_f f defined_g g s2 t2))
(assert (not (fits defined_f f defined_g g s t)))
