// The integrals of src/optics (exp.rs, attenuation.rs, integral.rs) under the same names; their constants are put in front.

fn polynomial2(c: array<f32, 2>, x: f32) -> f32 { return c[1] * x + c[0]; }
fn polynomial3(c: array<f32, 3>, x: f32) -> f32 { return (c[2] * x + c[1]) * x + c[0]; }
fn polynomial4(c: array<f32, 4>, x: f32) -> f32 { return ((c[3] * x + c[2]) * x + c[1]) * x + c[0]; }
fn polynomial5(c: array<f32, 5>, x: f32) -> f32 {
    return (((c[4] * x + c[3]) * x + c[2]) * x + c[1]) * x + c[0];
}
fn polynomial6(c: array<f32, 6>, x: f32) -> f32 {
    return ((((c[5] * x + c[4]) * x + c[3]) * x + c[2]) * x + c[1]) * x + c[0];
}
fn polynomial7(c: array<f32, 7>, x: f32) -> f32 {
    return (((((c[6] * x + c[5]) * x + c[4]) * x + c[3]) * x + c[2]) * x + c[1]) * x + c[0];
}

// e^-x for x >= 0: n = x / ln 2 rounded, r the rest, 2^-n by its bits.
fn exp_neg(x: f32) -> f32 {
    let clamped = min(x, UNDERFLOW);
    let n = round(clamped * LOG2_E);
    let r = (clamped - n * LN_2_HIGH) - n * LN_2_LOW;
    let scale = bitcast<f32>((127u - u32(n)) << 23u);
    let value = ((1.0 - r) + r * r * polynomial5(EXP_TAIL, r)) * scale;
    return select(value, 0.0, x > UNDERFLOW);
}

// 1 - e^-x for 0 <= x <= 1.
fn one_minus_exp_neg_small(x: f32) -> f32 {
    return x + x * (x * polynomial6(ONE_MINUS_TAIL, x));
}

// 1 - e^-x for x >= 0.
fn one_minus_exp_neg(x: f32) -> f32 {
    if x < 1.0 {
        return one_minus_exp_neg_small(x);
    }
    return 1.0 - exp_neg(x);
}

// Q in J = e^(-m/2) (1 + Q).
fn thin_excess(m: f32, delta: f32) -> f32 {
    let mm = m * m;
    let by_delta = array<f32, 5>(
        polynomial4(Q1, mm), polynomial3(Q2, mm), polynomial3(Q3, mm), polynomial2(Q4, mm), Q5,
    );
    return mm * polynomial4(Q0, mm) + delta * polynomial5(by_delta, delta);
}

fn thick_rising_end(depth: f32, shift: f32) -> f32 {
    let reciprocal = 1.0 / (depth + shift);
    let p = shift * reciprocal;
    return reciprocal * polynomial7(RISING_TOP, p) / polynomial7(RISING_BOTTOM, p);
}

fn thick_falling_end(depth: f32, shift: f32) -> f32 {
    let reciprocal = 1.0 / (depth * depth + shift);
    let p = shift * reciprocal;
    return depth * reciprocal * polynomial7(FALLING_TOP, p) / polynomial7(FALLING_BOTTOM, p);
}

// J for (x + y)/2 >= THIN_LIMIT, given T = e^(-(x + y)/2).
fn thick(x: f32, y: f32, transmittance: f32) -> f32 {
    let a = min(x, DEPTH_LIMIT);
    let b = min(y, DEPTH_LIMIT);
    let delta = 0.5 * (b - a);
    if delta > 0.0 {
        let shift = RISING_SHIFT * sqrt(delta);
        return thick_rising_end(a, shift) - transmittance * thick_rising_end(b, shift);
    }
    let shift = FALLING_SHIFT * abs(delta);
    return thick_falling_end(a, shift) - transmittance * thick_falling_end(b, shift);
}

// What a segment adds: light w0 c0 + w1 c1, opacity w0 + w1.
struct SegmentWeights {
    w0: f32,
    w1: f32,
    transmittance: f32,
}

fn segment_weights_very_thin(x: f32, y: f32) -> SegmentWeights {
    let m = 0.5 * (x + y);
    let delta = 0.5 * (y - x);
    let half = 0.5 * m;
    let loss = half * (1.0 - half * (0.5 - half * (1.0 / 6.0 - half * (1.0 / 24.0))));
    let h = 1.0 - loss;
    let mm = m * m;
    let by_delta = (1.0 / 6.0 + mm * (1.0 / 240.0)) + delta * (1.0 / 60.0 + delta * (1.0 / 840.0));
    let excess = mm * (1.0 / 24.0) + delta * by_delta;
    return SegmentWeights(loss - h * excess, h * (loss + excess), h * h);
}

fn segment_weights_thin(x: f32, y: f32) -> SegmentWeights {
    let m = 0.5 * (x + y);
    let loss = one_minus_exp_neg_small(0.5 * m);
    let h = 1.0 - loss;
    let excess = thin_excess(m, 0.5 * (y - x));
    return SegmentWeights(loss - h * excess, h * (loss + excess), h * h);
}

// The exact integral for optical depths x, y >= 0 of a segment, as if its whole length had the extinction of its entry, of its exit.
fn segment_weights(x: f32, y: f32) -> SegmentWeights {
    let m = 0.5 * x + 0.5 * y;
    if m <= VERY_THIN_LIMIT {
        return segment_weights_very_thin(x, y);
    }
    if m <= THIN_LIMIT {
        return segment_weights_thin(x, y);
    }
    let transmittance = exp_neg(m);
    let j = thick(x, y, transmittance);
    return SegmentWeights(1.0 - j, j - transmittance, transmittance);
}

// The papers' average of both ends.
fn segment_weights_average(x: f32, y: f32) -> SegmentWeights {
    let m = 0.5 * x + 0.5 * y;
    let half = 0.5 * one_minus_exp_neg(m);
    return SegmentWeights(half, half, exp_neg(m));
}

// ∫₀¹ (k0 + (k1 - k0) t)(c0 + (c1 - c0) t) dt.
fn product_mean(k0: f32, k1: f32, c0: vec3<f32>, c1: vec3<f32>) -> vec3<f32> {
    return (k0 * (2.0 * c0 + c1) + k1 * (c0 + 2.0 * c1)) * (1.0 / 6.0);
}
