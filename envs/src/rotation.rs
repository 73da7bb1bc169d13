//! Rotations in the reference's conventions: quaternions [w, x, y, z], Euler angles about the rotating axes
//! x, y, z.
//!
//! The formulas are those of the reference's `rotations.py`, in the same order of operations, so that
//! replayed resets agree to the last bit.

use std::f64::consts::FRAC_PI_2;

use crate::metric::norm;

/// A quaternion [w, x, y, z].
pub(crate) type Quat = [f64; 4];
/// A rotation matrix, row after row.
pub(crate) type Matrix = [f64; 9];

/// Below this the middle angle is ±90° and the two others cannot be told apart.
const GIMBAL_LOCK: f64 = 4.0 * f64::EPSILON;

/// The rotation by `angle` (radians) about `axis`, which needs no unit length.
pub(crate) fn from_angle_and_axis(angle: f64, axis: [f64; 3]) -> Quat {
    let length = norm(&axis);
    let (sin, cos) = (angle / 2.0).sin_cos();
    let [x, y, z] = axis.map(|part| sin * (part / length));
    normalized([cos, x, y, z])
}

/// `q` scaled to unit length.
pub(crate) fn normalized(q: Quat) -> Quat {
    let length = norm(&q);
    q.map(|part| part / length)
}

/// The Hamilton product a·b: first b, then a.
pub(crate) fn product(a: Quat, b: Quat) -> Quat {
    let ([w0, x0, y0, z0], [w1, x1, y1, z1]) = (a, b);
    [
        w0 * w1 - x0 * x1 - y0 * y1 - z0 * z1,
        w0 * x1 + x0 * w1 + y0 * z1 - z0 * y1,
        w0 * y1 + y0 * w1 + z0 * x1 - x0 * z1,
        w0 * z1 + z0 * w1 + x0 * y1 - y0 * x1,
    ]
}

/// The inverse of a unit quaternion.
pub(crate) fn conjugate([w, x, y, z]: Quat) -> Quat {
    [w, -x, -y, -z]
}

/// Angle 2·acos(w) of a·conj(b), radians in [0, 2π]. The reference takes no absolute value: q and −q, the
/// same rotation, lie 2π apart.
pub(crate) fn angle_between(a: Quat, b: Quat) -> f64 {
    2.0 * product(a, conjugate(b))[0].clamp(-1.0, 1.0).acos()
}

/// Euler angles of a rotation matrix, radians.
pub(crate) fn matrix_to_euler(m: &Matrix) -> [f64; 3] {
    let cy = (m[8] * m[8] + m[5] * m[5]).sqrt();
    let y = -(-m[2]).atan2(cy);
    if cy > GIMBAL_LOCK { [-m[5].atan2(m[8]), y, -m[1].atan2(m[0])] } else { [0.0, y, -(-m[3]).atan2(m[4])] }
}

/// The rotation matrix of Euler angles.
fn euler_to_matrix([x, y, z]: [f64; 3]) -> Matrix {
    let ((si, ci), (sj, cj), (sk, ck)) = ((-z).sin_cos(), (-y).sin_cos(), (-x).sin_cos());
    let (cc, cs, sc, ss) = (ci * ck, ci * sk, si * ck, si * sk);
    [cj * ci, cj * si, -sj, sj * cs - sc, sj * ss + cc, cj * sk, sj * cc + ss, sj * sc - cs, cj * ck]
}

/// The quaternion of Euler angles.
pub(crate) fn euler_to_quat([x, y, z]: [f64; 3]) -> Quat {
    let ((si, ci), (sj, cj), (sk, ck)) = ((z / 2.0).sin_cos(), (-y / 2.0).sin_cos(), (x / 2.0).sin_cos());
    let (cc, cs, sc, ss) = (ci * ck, ci * sk, si * ck, si * sk);
    [cj * cc + sj * ss, cj * cs - sj * sc, -(cj * ss + sj * cc), cj * sc - sj * cs]
}

/// Euler angles of a quaternion of any length but 0.
pub(crate) fn quat_to_euler(q: Quat) -> [f64; 3] {
    matrix_to_euler(&quat_to_matrix(q))
}

/// The rotation matrix of a quaternion of any length; the identity for 0.
fn quat_to_matrix(q: Quat) -> Matrix {
    let square: f64 = q.iter().map(|part| part * part).sum();
    if square <= f64::EPSILON {
        return [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
    }
    let s = 2.0 / square;
    let [w, x, y, z] = q;
    let (xs, ys, zs) = (x * s, y * s, z * s);
    let (wx, wy, wz) = (w * xs, w * ys, w * zs);
    let (xx, xy, xz) = (x * xs, x * ys, x * zs);
    let (yy, yz, zz) = (y * ys, y * zs, z * zs);
    [1.0 - (yy + zz), xy - wz, xz + wy, xy + wz, 1.0 - (xx + zz), yz - wx, xz - wy, yz + wx, 1.0 - (xx + yy)]
}

/// The 24 rotations that map a cube onto itself, in the reference's order: all triples of quarter turns 0,
/// 90°, −90°, 180° (the last axis fastest), each brought to canonical Euler angles, repetitions left out.
pub(crate) fn parallel_rotations() -> Vec<Quat> {
    const TURNS: [f64; 4] = [0.0, FRAC_PI_2, -FRAC_PI_2, 2.0 * FRAC_PI_2];
    let pairs = TURNS.iter().flat_map(|&x| TURNS.iter().map(move |&y| (x, y)));
    let triples = pairs.flat_map(|(x, y)| TURNS.iter().map(move |&z| [x, y, z]));
    let mut distinct: Vec<[f64; 3]> = Vec::with_capacity(24);
    for triple in triples {
        let canonical = canonical_quarter_turns(triple);
        if !distinct.contains(&canonical) {
            distinct.push(canonical);
        }
    }
    distinct.into_iter().map(euler_to_quat).collect()
}

/// The Euler angles that `matrix_to_euler` gives for a triple of quarter turns, rounded to quarter turns,
/// with +180° for −180° in the outer angles.
fn canonical_quarter_turns(triple: [f64; 3]) -> [f64; 3] {
    let [x, y, z] = matrix_to_euler(&euler_to_matrix(triple)).map(|angle| (angle / FRAC_PI_2).round());
    let positive = |quarters: f64| if quarters == -2.0 { 2.0 } else { quarters };
    [positive(x), y, positive(z)].map(|quarters| quarters * FRAC_PI_2)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2, FRAC_PI_6, PI};

    use super::*;

    #[track_caller]
    fn assert_close<const N: usize>(got: [f64; N], expected: [f64; N]) {
        assert!(got.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{got:?} != {expected:?}");
    }

    /// 90° about z: x → y.
    const QUARTER_Z: Quat = [FRAC_1_SQRT_2, 0.0, 0.0, FRAC_1_SQRT_2];
    /// 90° about x: y → z.
    const QUARTER_X: Quat = [FRAC_1_SQRT_2, FRAC_1_SQRT_2, 0.0, 0.0];

    #[test]
    fn a_quarter_turn_about_a_long_axis() {
        assert_close(from_angle_and_axis(FRAC_PI_2, [0.0, 0.0, 5.0]), QUARTER_Z);
    }

    #[test]
    fn product_of_two_quarter_turns_is_a_third_of_a_turn() {
        // About z after about x: x → y → ... the axis is (1, 1, 1)/√3, the angle 120°, so w = 1/2 and each
        // part 1/2.
        assert_close(product(QUARTER_Z, QUARTER_X), [0.5, 0.5, 0.5, 0.5]);
        assert_close(product(QUARTER_Z, conjugate(QUARTER_Z)), [1.0, 0.0, 0.0, 0.0]);
    }

    #[test]
    fn angle_between_rotations_sees_the_sign() {
        assert!((angle_between(QUARTER_Z, [1.0, 0.0, 0.0, 0.0]) - FRAC_PI_2).abs() < 1e-12);
        assert_eq!(angle_between(QUARTER_Z, QUARTER_Z.map(|part| -part)), 2.0 * PI);
    }

    #[test]
    fn euler_angles_of_a_turn_about_z() {
        let (s, c) = FRAC_PI_6.sin_cos();
        let turn = [c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0];
        assert_close(matrix_to_euler(&turn), [0.0, 0.0, FRAC_PI_6]);
        assert_close(euler_to_matrix([0.0, 0.0, FRAC_PI_6]), turn);
    }

    #[test]
    fn euler_angles_at_gimbal_lock_put_everything_on_z() {
        // 30° about z, then 90° about y: R = Ry·Rz.
        let (s, c) = FRAC_PI_6.sin_cos();
        let locked = [0.0, 0.0, 1.0, s, c, 0.0, -c, s, 0.0];
        assert_close(matrix_to_euler(&locked), [0.0, FRAC_PI_2, FRAC_PI_6]);
    }

    #[test]
    fn quaternions_matrices_and_euler_angles_agree() {
        let angles = [0.3, -0.7, 1.9];
        let quat = euler_to_quat(angles);
        assert_close(quat_to_euler(quat.map(|part| 3.0 * part)), angles);
        assert_close(quat_to_matrix(quat), euler_to_matrix(angles));
        assert_close(euler_to_quat([FRAC_PI_2, 0.0, 0.0]), QUARTER_X);
    }

    #[test]
    fn a_cube_has_24_rotations() {
        let all = parallel_rotations();
        assert_eq!(all.len(), 24);
        assert_close(all[0], [1.0, 0.0, 0.0, 0.0]);
        assert_close(all[1], QUARTER_Z);
        for (i, a) in all.iter().enumerate() {
            // q and −q are the same rotation, so only the absolute value of the product counts.
            let twins = all[..i].iter().filter(|b| product(*a, conjugate(**b))[0].abs() > 0.99);
            assert_eq!(twins.count(), 0, "rotation {i} repeats an earlier one");
        }
    }
}
