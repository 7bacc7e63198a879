; Definitions for the statements beside this file. docs/parts.md explains them.

; A step has the value f where it is defined. Its substitute has the value g. Thresholds are -s and t.
(define-fun fits ((defined_f Bool) (f Real) (defined_g Bool) (g Real) (s Real) (t Real)) Bool
  (and (= defined_f defined_g)
       (=> defined_f
           (and (=> (and (<= (- s) f) (<= f t)) (= g f))
                (= (> f t) (> g t))
                (= (< f (- s)) (< g (- s)))))))

; Bounds hold wherever there is a value.
(define-fun within ((defined Bool) (value Real) (lo Real) (hi Real)) Bool
  (=> defined (and (<= lo value) (<= value hi))))

(define-fun least ((a Real) (b Real)) Real (ite (<= a b) a b))
(define-fun most ((a Real) (b Real)) Real (ite (<= a b) b a))
(define-fun size ((a Real)) Real (most a (- a)))

; The quadratic blend of a and b with width k and factor c.
(define-fun blend ((a Real) (b Real) (k Real) (c Real)) Real
  (let ((h (most 0.0 (- k (size (- a b)))))) (- (least a b) (* c h h))))

; Thresholds that are not beyond bounds of the value.
(define-fun upper ((s Real) (t Real) (hi Real)) Real (most (least t hi) (- s)))
(define-fun lower ((s Real) (t Real) (lo Real) (hi Real)) Real
  (- (least (most (- s) lo) (upper s t hi))))

; A step, its operands a, b and q, and their substitutes.
(declare-const defined_f Bool) (declare-const f Real)
(declare-const defined_g Bool) (declare-const g Real)
(declare-const defined_a Bool) (declare-const a Real)
(declare-const defined_a2 Bool) (declare-const a2 Real)
(declare-const defined_b Bool) (declare-const b Real)
(declare-const defined_b2 Bool) (declare-const b2 Real)
(declare-const defined_q Bool) (declare-const q Real)
(declare-const defined_q2 Bool) (declare-const q2 Real)
; The thresholds of the step, and bounds of values in the part of space.
(declare-const s Real) (declare-const t Real)
(assert (<= (- s) t))
(declare-const lo Real) (declare-const hi Real)
(declare-const lo_a Real) (declare-const hi_a Real)
(declare-const lo_b Real) (declare-const hi_b Real)
(assert (within defined_a a lo_a hi_a))
(assert (within defined_b b lo_b hi_b))
; Constants of the step.
(declare-const k Real) (declare-const c Real)
