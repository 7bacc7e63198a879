; Bounds of a minimum and a maximum.
(assert defined_a)
(assert defined_b)
(assert (not (and (within true (least a b) (least lo_a lo_b) (least hi_a hi_b)) (within true (most a b) (most lo_a lo_b) (most hi_a hi_b)))))
