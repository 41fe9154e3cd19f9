// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "playback/packed_kernels.h"

#include <algorithm>
#include <cmath>

#include "model/field_warp.h"
#if defined(__SSE2__)
#include <emmintrin.h>
#endif

#define PALPATE_INLINE __attribute__((always_inline)) inline
// One version with AVX2 and one without, chosen at run time. They give the same bits: fused
// multiply-add is off, and sums have the same order. Before clang 18, other sources do not find the
// versions: they call functions that call these. The name is that of a feature, not of a level such
// as x86-64-v3: clang 14 accepts levels, but does not select by them.
#if defined(PALPATE_FOR_EACH_PROCESSOR)
// Given by a test, which compiles one version.
#elif defined(__x86_64__) && defined(__OPTIMIZE__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define PALPATE_FOR_EACH_PROCESSOR __attribute__((target_clones("avx2", "default")))
#else
#define PALPATE_FOR_EACH_PROCESSOR
#endif

namespace palpate::haptics {

namespace packed {
namespace {

// The inward normal of a contact is turned to that of the place in closed form where the cosine
// between them is at least this much above -1. Nearer to half a turn it loses digits.
constexpr double kLeastCosineAboveMinusOne = 1e-3;

// Four numbers. A struct, since how a bare vector of 32 bytes is passed and returned depends on the
// processor that is compiled for.
struct Vector4 {
  using Lane4 __attribute__((vector_size(32), may_alias)) = double;

  Vector4() = default;
  // Both convert without a word, as the numbers and the vectors of the compiler do.
  // NOLINTBEGIN(google-explicit-constructor)
  PALPATE_INLINE Vector4(const Lane4& lanes) : of{lanes} {}
  PALPATE_INLINE Vector4(double all) : of{all, all, all, all} {}
  // NOLINTEND(google-explicit-constructor)
  PALPATE_INLINE double operator[](int lane) const { return of[lane]; }
  PALPATE_INLINE void operator+=(const Vector4& other) { of += other.of; }
  PALPATE_INLINE void operator-=(const Vector4& other) { of -= other.of; }
  PALPATE_INLINE void operator*=(const Vector4& other) { of *= other.of; }

  Lane4 of;
};

PALPATE_INLINE Vector4 operator+(const Vector4& a, const Vector4& b) { return a.of + b.of; }
PALPATE_INLINE Vector4 operator-(const Vector4& a, const Vector4& b) { return a.of - b.of; }
PALPATE_INLINE Vector4 operator*(const Vector4& a, const Vector4& b) { return a.of * b.of; }
PALPATE_INLINE Vector4 operator/(const Vector4& a, const Vector4& b) { return a.of / b.of; }
PALPATE_INLINE Vector4 smaller(const Vector4& a, const Vector4& b) {
  return a.of < b.of ? a.of : b.of;
}

PALPATE_INLINE Vector4 load(const Lanes& lanes) {
  return *reinterpret_cast<const Vector4::Lane4*>(lanes.of.data());
}
PALPATE_INLINE void store(Lanes& lanes, const Vector4& value) {
  *reinterpret_cast<Vector4::Lane4*>(lanes.of.data()) = value.of;
}

PALPATE_INLINE Vector4 square_root(const Vector4& value) {
#if defined(__SSE2__)
  const __m128d low = _mm_sqrt_pd(_mm_set_pd(value[1], value[0]));
  const __m128d high = _mm_sqrt_pd(_mm_set_pd(value[3], value[2]));
  return Vector4::Lane4{low[0], low[1], high[0], high[1]};
#else
  return Vector4::Lane4{std::sqrt(value[0]), std::sqrt(value[1]), std::sqrt(value[2]),
                        std::sqrt(value[3])};
#endif
}

// The sums over the lanes of a, b, c and d.
PALPATE_INLINE Vector4 sums(const Vector4& a, const Vector4& b, const Vector4& c,
                            const Vector4& d) {
  const Vector4::Lane4 ab = __builtin_shufflevector(a.of, b.of, 0, 4, 2, 6) +
                            __builtin_shufflevector(a.of, b.of, 1, 5, 3, 7);
  const Vector4::Lane4 cd = __builtin_shufflevector(c.of, d.of, 0, 4, 2, 6) +
                            __builtin_shufflevector(c.of, d.of, 1, 5, 3, 7);
  return __builtin_shufflevector(ab, cd, 0, 1, 4, 5) + __builtin_shufflevector(ab, cd, 2, 3, 6, 7);
}

// Adds gradient and energy of four bases at x.
PALPATE_INLINE void add_isotropic(const PackedField::IsotropicBases& bases, const Vector4* x,
                                  Vector4* gradient, Vector4& energy) {
  const Vector4 a = x[0] - load(bases.center[0]), b = x[1] - load(bases.center[1]),
                c = x[2] - load(bases.center[2]);
  const Vector4 s = square_root(a * a + b * b + c * c + load(bases.squared_epsilon));
  const Vector4 weight = load(bases.weight), q = weight / s;
  gradient[0] += q * a;
  gradient[1] += q * b;
  gradient[2] += q * c;
  energy += weight * s;
}

PALPATE_INLINE void add_ridges(const PackedField::RidgeBases& bases, const Vector4* x,
                               Vector4* gradient, Vector4& energy) {
  const Vector4 r0 = load(bases.ridge[0]), r1 = load(bases.ridge[1]), r2 = load(bases.ridge[2]);
  const Vector4 a = r0 * x[0] + r1 * x[1] + r2 * x[2] - load(bases.offset);
  const Vector4 s = square_root(a * a + load(bases.squared_epsilon));
  const Vector4 weight = load(bases.weight), q = weight * a / s;
  gradient[0] += q * r0;
  gradient[1] += q * r1;
  gradient[2] += q * r2;
  energy += weight * s;
}

PALPATE_INLINE void add_bases(const Bases& bases, int contact, const Vector4* x, Vector4* gradient,
                              Vector4& energy) {
  const PackedField::BaseRange& range = bases.ranges[contact];
  for (int i = range.first_isotropic; i < range.isotropic_end; ++i)
    add_isotropic(bases.isotropic[i], x, gradient, energy);
  for (int i = range.first_ridge; i < range.ridge_end; ++i)
    add_ridges(bases.ridges[i], x, gradient, energy);
}

PALPATE_FOR_EACH_PROCESSOR
void evaluate_place(const PlaceField& place, const Bases& bases, const double* displacement,
                    Lanes& result) noexcept {
  const Vector4 d0(displacement[0]), d1(displacement[1]), d2(displacement[2]);
  Vector4 f0(0), f1(0), f2(0), total(0);
  const int packs = (place.count + 3) / 4;
  for (int p = 0; p < packs; ++p) {
    const Lanes* const to_local = place.to_local[static_cast<std::size_t>(p)].data();
    const Lanes* const constant = place.constants[static_cast<std::size_t>(p)].data();
    Vector4 x[3], gradient[4][3] = {}, energy[4] = {};
    for (int i = 0; i < 3; ++i) {
      x[i] = load(to_local[3 * i]) * d0 + load(to_local[3 * i + 1]) * d1 +
             load(to_local[3 * i + 2]) * d2;
    }
    const int lanes = std::min(4, place.count - 4 * p);
    for (int k = 0; k < lanes; ++k) {
      const Vector4 own[3] = {x[0][k], x[1][k], x[2][k]};
      add_bases(bases, place.contacts[static_cast<std::size_t>(4 * p + k)], own, gradient[k],
                energy[k]);
    }
    Vector4 g[3];
    Vector4 e = sums(energy[0], energy[1], energy[2], energy[3]) - load(constant[kEnergyAtZero]);
    for (int i = 0; i < 3; ++i) {
      const Vector4 at_zero = load(constant[kGradientAtZero + i]);
      g[i] = sums(gradient[0][i], gradient[1][i], gradient[2][i], gradient[3][i]) - at_zero;
      e -= at_zero * x[i];
    }
    const Vector4 scale = load(place.scale[static_cast<std::size_t>(p)]);
    for (int i = 0; i < 3; ++i) g[i] *= scale;
    f0 += load(to_local[0]) * g[0] + load(to_local[3]) * g[1] + load(to_local[6]) * g[2];
    f1 += load(to_local[1]) * g[0] + load(to_local[4]) * g[1] + load(to_local[7]) * g[2];
    f2 += load(to_local[2]) * g[0] + load(to_local[5]) * g[1] + load(to_local[8]) * g[2];
    total += scale * e;
  }
  store(result, sums(f0, f1, f2, total));
}

PALPATE_FOR_EACH_PROCESSOR
void evaluate_contact(const Bases& bases, int contact, const double* x, Lanes& result) noexcept {
  const Vector4 own[3] = {x[0], x[1], x[2]};
  Vector4 gradient[3] = {}, energy = {};
  add_bases(bases, contact, own, gradient, energy);
  store(result, sums(gradient[0], gradient[1], gradient[2], energy));
}

// A compliance after a turn by the angle with this cosine and sine.
PALPATE_INLINE void turn_compliance(const Vector4* from, const Vector4& cosine, const Vector4& sine,
                                    Vector4* to) {
  to[0] = cosine * from[0] - sine * from[1];
  to[1] = sine * from[0] + cosine * from[1];
  to[2] = from[2];
  const Vector4 double_cosine = cosine * cosine - sine * sine, double_sine = 2.0 * cosine * sine;
  const Vector4 mean = 0.5 * (from[3] + from[5]), half = 0.5 * (from[3] - from[5]);
  const Vector4 turned = half * double_cosine - from[4] * double_sine;
  to[3] = mean + turned;
  to[4] = half * double_sine + from[4] * double_cosine;
  to[5] = mean - turned;
}

// Does the work of `carried_frame`, `turn_between`, `compliance_between` and `warp_between` of
// `BlendedField`, in closed form and in coordinates of the pressing frames. Returns false if that
// form does not hold.
template <int kCount>
PALPATE_INLINE bool blend(const double* position, double reach, const Lanes* weights,
                          PlaceField& place) {
  Vector4 normals(0), cones(0), places(0), axes(0);
  for (int p = 0; p < kCount; ++p) {
    const Lanes* const c = place.constants[p].data();
    const Vector4 w = load(weights[p]);
    normals += sums(w * load(c[kPressing + 6]), w * load(c[kPressing + 7]),
                    w * load(c[kPressing + 8]), w * load(c[kFriction]));
    cones += sums(w * load(c[kCone]), w * load(c[kCone + 1]), w * load(c[kCone + 2]),
                  w * load(c[kLoadExponent]));
    places +=
        sums(w * load(c[kPosition]), w * load(c[kPosition + 1]), w * load(c[kPosition + 2]), w);
    axes += sums(w * load(c[kAxis]), w * load(c[kAxis + 1]), w * load(c[kAxis + 2]), w);
  }
  place.friction = normals[3];
  place.load_exponent = cones[3];
  const double normal_length =
      std::sqrt(normals[0] * normals[0] + normals[1] * normals[1] + normals[2] * normals[2]);
  const double cone_length =
      std::sqrt(cones[0] * cones[0] + cones[1] * cones[1] + cones[2] * cones[2]);
  if (!(normal_length > kLeastCosineAboveMinusOne && cone_length > kLeastCosineAboveMinusOne))
    return false;
  const double per_cone = 1 / cone_length, per_normal = 1 / normal_length;
  place.cone_axis = Eigen::Vector3d(cones[0], cones[1], cones[2]) * per_cone;
  place.friction_axis = Eigen::Vector3d(axes[0], axes[1], axes[2]);
  const double bx = normals[0] * per_normal, by = normals[1] * per_normal,
               bz = normals[2] * per_normal;
  // Two axes perpendicular to b (Duff et al. 2017). Which ones makes no difference.
  const double sign = bz >= 0 ? 1.0 : -1.0, a = -1 / (sign + bz), b = bx * by * a;
  const double q[3][3] = {
      {1 + sign * bx * bx * a, sign * b, -sign * bx}, {b, sign + by * by * a, -by}, {bx, by, bz}};
  double beyond[3] = {position[0] - places[0], position[1] - places[1], position[2] - places[2]};
  const double distance =
      std::sqrt(beyond[0] * beyond[0] + beyond[1] * beyond[1] + beyond[2] * beyond[2]);
  if (distance > reach) {
    for (double& x : beyond) x *= reach / distance;
  }
  Vector4 own[kCount][6], cosines[kCount], sines[kCount];
  Vector4 first(0), second(0), third(0);
  Vector4 least_cosine(2);
  for (int p = 0; p < kCount; ++p) {
    const Lanes* const c = place.constants[p].data();
    const Vector4 w = load(weights[p]);
    const Vector4 above = 1.0 + (load(c[kPressing + 6]) * bx + load(c[kPressing + 7]) * by +
                                 load(c[kPressing + 8]) * bz);
    least_cosine = smaller(above, least_cosine);
    // The x axis of the pressing frame after the smallest turn of its z axis to b.
    const Vector4 k =
        (load(c[kPressing]) * bx + load(c[kPressing + 1]) * by + load(c[kPressing + 2]) * bz) /
        above;
    const Vector4 t0 = load(c[kPressing]) - k * (load(c[kPressing + 6]) + bx),
                  t1 = load(c[kPressing + 1]) - k * (load(c[kPressing + 7]) + by),
                  t2 = load(c[kPressing + 2]) - k * (load(c[kPressing + 8]) + bz);
    cosines[p] = q[0][0] * t0 + q[0][1] * t1 + q[0][2] * t2;
    sines[p] = q[1][0] * t0 + q[1][1] * t1 + q[1][2] * t2;
    const Vector4 e0 = places[0] - load(c[kPosition]), e1 = places[1] - load(c[kPosition + 1]),
                  e2 = places[2] - load(c[kPosition + 2]);
    const Vector4 u0 = load(c[kPressing]) * e0 + load(c[kPressing + 1]) * e1 +
                       load(c[kPressing + 2]) * e2,
                  u1 = load(c[kPressing + 3]) * e0 + load(c[kPressing + 4]) * e1 +
                       load(c[kPressing + 5]) * e2;
    const Vector4 v0 = load(c[kPressing]) * beyond[0] + load(c[kPressing + 1]) * beyond[1] +
                       load(c[kPressing + 2]) * beyond[2],
                  v1 = load(c[kPressing + 3]) * beyond[0] + load(c[kPressing + 4]) * beyond[1] +
                       load(c[kPressing + 5]) * beyond[2];
    const Vector4 terms[5] = {2.0 / 3 * u0 + v0, 2.0 / 3 * u1 + v1,
                              1.0 / 6 * u0 * u0 + u0 * v0 + 0.5 * v0 * v0,
                              1.0 / 3 * u0 * u1 + u0 * v1 + u1 * v0 + v0 * v1,
                              1.0 / 6 * u1 * u1 + u1 * v1 + 0.5 * v1 * v1};
    Vector4 values[6], step[6], change[6];
    for (int i = 0; i < 6; ++i) {
      values[i] = load(c[kValues + i]);
      step[i] = load(c[kTrend + 5 * i]) * terms[0];
      for (int j = 1; j < 5; ++j) step[i] += load(c[kTrend + 5 * i + j]) * terms[j];
    }
    turn_compliance(values, cosines[p], sines[p], own[p]);
    turn_compliance(step, cosines[p], sines[p], change);
    first += sums(w * own[p][0], w * own[p][1], w * own[p][2], w * change[2]);
    second += sums(w * own[p][3], w * own[p][4], w * own[p][5], w * change[5]);
    third += sums(w * change[0], w * change[1], w * change[3], w * change[4]);
  }
  const double ma = second[0], mb = second[1], md = second[2];
  const double ca = third[2], cb = third[3], cd = second[3];
  const double determinant = ma * md - mb * mb;
  const double r00 = md * ca - mb * cb, r01 = md * cb - mb * cd, r10 = ma * cb - mb * ca,
               r11 = ma * cd - mb * cb;
  // Squares of the relative changes across and along z, times those of determinant and mean.
  const double across = r00 * r00 + 2 * r01 * r10 + r11 * r11, along = first[3] * first[3];
  const double square = determinant * determinant, mean = first[2] * first[2];
  double part = 1;
  if (across > kMaxChange * kMaxChange * square || along > kMaxChange * kMaxChange * mean)
    part = kMaxChange / std::sqrt(std::max(across / square, along / mean));
  const double ux = first[0] + part * third[0], uy = first[1] + part * third[1],
               uz = first[2] + part * first[3];
  const double ha = ma + part * ca, hb = mb + part * cb, hd = md + part * cd;
  const double inverse_root = 1 / std::sqrt(ha * hd - hb * hb), inverse_depth = 1 / uz;
  bool good = std::isfinite(inverse_root) && std::isfinite(inverse_depth);
  for (int k = 0; k < 4; ++k) good = good && least_cosine[k] > kLeastCosineAboveMinusOne;
  for (int p = 0; p < kCount; ++p) {
    const Lanes* const c = place.constants[p].data();
    const Vector4* const k = own[p];
    const Vector4 root = load(c[kInverseRoot]);
    const Vector4 s00 = k[3] * root + hd * inverse_root, s01 = k[4] * root - hb * inverse_root,
                  s11 = k[5] * root + ha * inverse_root;
    const Vector4 energy = uz * load(c[kInverseDepth]);
    const Vector4 factor =
        square_root(load(c[kRoot]) * inverse_root / ((s00 * s11 - s01 * s01) * energy));
    const Vector4 m0 = factor * s00, m1 = factor * s01, m2 = factor * s11;
    const Vector4 m3 = (k[0] - m0 * ux - m1 * uy) * inverse_depth,
                  m4 = (k[1] - m1 * ux - m2 * uy) * inverse_depth,
                  m5 = load(c[kValues + 2]) * inverse_depth;
    const Vector4 cosine = cosines[p], sine = sines[p];
    const Vector4 rows[2][3] = {
        {cosine * m0 + sine * m1, cosine * m1 + sine * m2, cosine * m3 + sine * m4},
        {cosine * m1 - sine * m0, cosine * m2 - sine * m1, cosine * m4 - sine * m3}};
    Lanes* const to_local = place.to_local[p].data();
    for (int j = 0; j < 3; ++j) {
      for (int i = 0; i < 2; ++i) {
        store(to_local[3 * i + j],
              rows[i][0] * q[0][j] + rows[i][1] * q[1][j] + rows[i][2] * q[2][j]);
      }
      store(to_local[6 + j], m5 * q[2][j]);
    }
    store(place.scale[p], load(weights[p]) * energy);
  }
  return good;
}

PALPATE_FOR_EACH_PROCESSOR
bool blend_contacts(const double* position, double reach, const Lanes* weights,
                    PlaceField& place) noexcept {
  switch ((place.count + 3) / 4) {
    case 1:
      return blend<1>(position, reach, weights, place);
    case 2:
      return blend<2>(position, reach, weights, place);
    default:
      return blend<3>(position, reach, weights, place);
  }
}

}  // namespace

void evaluate(const PlaceField& place, const Bases& bases, const double* displacement,
              Lanes& result) noexcept {
  evaluate_place(place, bases, displacement, result);
}

void evaluate_bases(const Bases& bases, int contact, const double* x, Lanes& result) noexcept {
  evaluate_contact(bases, contact, x, result);
}

bool blend_places(const double* position, double reach, const Lanes* weights,
                  PlaceField& place) noexcept {
  return blend_contacts(position, reach, weights, place);
}

}  // namespace packed
}  // namespace palpate::haptics
