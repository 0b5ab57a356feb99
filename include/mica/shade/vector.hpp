// mica/shade/vector.hpp: directions and colours, no more than shading needs.
#pragma once

#include "../numeric/elementary.hpp"

namespace mica {

/// A vector of three, in space or in directions (then of length 1).
template <real_number Real>
struct vector3 {
    Real x, y, z; ///< the components

    /// Component by component.
    MICA_HOST_DEVICE friend constexpr vector3 operator+(vector3 a, vector3 b) {
        return {a.x + b.x, a.y + b.y, a.z + b.z};
    }
    /// Component by component.
    MICA_HOST_DEVICE friend constexpr vector3 operator-(vector3 a, vector3 b) {
        return {a.x - b.x, a.y - b.y, a.z - b.z};
    }
    /// Scaled.
    MICA_HOST_DEVICE friend constexpr vector3 operator*(Real s, vector3 a) { return {s * a.x, s * a.y, s * a.z}; }
};

/// The scalar product.
template <real_number Real>
MICA_HOST_DEVICE constexpr Real dot(vector3<Real> a, vector3<Real> b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

/// The vector product.
template <real_number Real>
MICA_HOST_DEVICE constexpr vector3<Real> cross(vector3<Real> a, vector3<Real> b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// if_true where the mask holds, if_false elsewhere.
template <real_number Real>
MICA_HOST_DEVICE constexpr vector3<Real> select(const mask_of<Real>& mask, vector3<Real> if_true,
                                                vector3<Real> if_false) {
    return {select(mask, if_true.x, if_false.x), select(mask, if_true.y, if_false.y),
            select(mask, if_true.z, if_false.z)};
}

/// a / |a|; a must not be zero.
template <real_number Real>
MICA_HOST_DEVICE constexpr vector3<Real> normalized(vector3<Real> a) {
    return (Real(1) / mica::sqrt(dot(a, a))) * a;
}

/// The direction into which a mirror with the given normal reflects what comes from `w`; both point away from it.
template <real_number Real>
MICA_HOST_DEVICE constexpr vector3<Real> reflected(vector3<Real> w, vector3<Real> normal) {
    return Real(2) * dot(w, normal) * normal - w;
}

/// Linear radiance or reflectance in three bands, Rec. 709 primaries.
template <real_number Real>
struct rgb {
    Real r, g, b; ///< red, green, blue

    /// Band by band.
    MICA_HOST_DEVICE friend constexpr rgb operator+(rgb a, rgb b) { return {a.r + b.r, a.g + b.g, a.b + b.b}; }
    /// Band by band.
    MICA_HOST_DEVICE friend constexpr rgb operator*(rgb a, rgb b) { return {a.r * b.r, a.g * b.g, a.b * b.b}; }
    /// Scaled.
    MICA_HOST_DEVICE friend constexpr rgb operator*(Real s, rgb a) { return {s * a.r, s * a.g, s * a.b}; }
};

/// Colours and lanes, as numbers have them (numeric/number.hpp).
template <real_number Real>
MICA_HOST_DEVICE constexpr void set_lane(rgb<Real>& colour, int i, rgb<float> value) {
    using Scalar = scalar_of<Real>;
    set_lane(colour.r, i, Scalar(value.r));
    set_lane(colour.g, i, Scalar(value.g));
    set_lane(colour.b, i, Scalar(value.b));
}

/// Relative luminance (Rec. 709).
template <real_number Real>
MICA_HOST_DEVICE constexpr Real luminance(rgb<Real> c) {
    return Real(0.2126) * c.r + Real(0.7152) * c.g + Real(0.0722) * c.b;
}

} // namespace mica
