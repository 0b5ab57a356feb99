// mica/grid/blended_uniforms.hpp: uniforms of a pixel, made of those of the vertices around it.
//
//     z = sum over the vertices of W_v z_v,   sum W_v^2 = 1,   xi = P(Z > z)
//
// Every vertex has a standard normal variate z_v; their blend with weights whose squares sum to 1 is standard normal at
// every place and continuous, so xi is uniform at every place, and whatever is drawn with it has exactly its law. (The
// variance-preserving blend of Deliot & Heitz 2019, done to the randomness instead of to a texture.) W is the product of
// the weights in the tetrahedron, in the triangle and among the half vectors, each divided by its norm.
//
// One hash of every seed makes two draws.
#pragma once

#include "../numeric/normal.hpp"
#include "../random/normal_pair.hpp"
#include "../random/uniform_stream.hpp"
#include "grid_vertices.hpp"

namespace mica {

namespace detail {

template <real_number Real>
MICA_HOST_DEVICE constexpr Real weight_of_variate(const angular_vertex<Real>& cell) {
    return cell.weight;
}
template <real_number Real, std::size_t HalfVectors>
MICA_HOST_DEVICE constexpr Real weight_of_variate(const grid_vertex<Real, HalfVectors>& vertex) {
    return vertex.variate_weight;
}
template <real_number Real, std::size_t HalfVectors>
MICA_HOST_DEVICE constexpr Real weight_of_variate(const pixel_grid<Real, HalfVectors>& grid) {
    return grid.variate_weight;
}

/// The weighted sum of the pairs of all elements.
template <real_number Real, class Elements, class Pair>
MICA_HOST_DEVICE constexpr normal_pair<Real> blended_pair(const Elements& elements, const Pair& pair) {
    normal_pair<Real> sum{Real(0), Real(0)};
    for (const auto& element : elements) {
        const normal_pair<Real> own = pair(element);
        sum.first = sum.first + weight_of_variate(element) * own.first;
        sum.second = sum.second + weight_of_variate(element) * own.second;
    }
    return sum;
}

} // namespace detail

/// blended_uniforms xi(vertices, index); xi() is the next uniform in the open (0,1) of this pixel. Streams with other
/// indices are independent. `Vertices` is a reference to grid_vertices, which must outlive it, or grid_vertices.
template <class Vertices>
class blended_uniforms {
  public:
    /// The number type of the uniforms.
    using number = typename std::remove_cvref_t<Vertices>::number;

    /// Stream `index` of these vertices.
    MICA_HOST_DEVICE explicit constexpr blended_uniforms(const std::remove_cvref_t<Vertices>& vertices,
                                                         std::uint32_t index = 0)
        : blended_uniforms(vertices, hash(index), 0) {}

    /// The next uniform, small where the variate is large.
    MICA_HOST_DEVICE constexpr number operator()() {
        using Limits = std::numeric_limits<scalar_of<number>>;
        return clamp(normal_cdf(-normal()), number((Limits::min)()), number(1 - Limits::epsilon() / 2));
    }

    /// The next standard normal variate.
    MICA_HOST_DEVICE constexpr number normal() {
        if (has_second_) {
            has_second_ = false;
            return second_;
        }
        counter_ += golden_increment;
        const auto round = index_of<number>(mix(index_ + counter_));
        const auto variates = [round](const auto& seeded) {
            return normal_pair_from_bits<number>(mix(round ^ seeded.seed));
        };
        const auto blended = detail::blended_pair<number>(vertices_.grids, [&](const auto& grid) {
            return detail::blended_pair<number>(grid.vertices, [&](const auto& vertex) {
                if constexpr (std::tuple_size_v<decltype(vertex.cells)> == 0)
                    return variates(vertex);
                else
                    return detail::blended_pair<number>(vertex.cells, variates);
            });
        });
        has_second_ = true;
        second_ = blended.second;
        return blended.first;
    }

    /// A new independent stream; this one goes on as if it had drawn twice, however much is drawn from the other.
    MICA_HOST_DEVICE constexpr blended_uniforms fork() {
        counter_ += golden_increment;
        return blended_uniforms(vertices_, index_ ^ mix(counter_), 0);
    }

    /// The stream of lane i, standing where this one stands.
    MICA_HOST_DEVICE constexpr auto lane(int i) const {
        auto own = lane_of_vertices(vertices_, i);
        blended_uniforms<decltype(own)> result(own, index_, counter_);
        result.has_second_ = has_second_;
        if (has_second_) result.second_ = detail::lane_of_number(second_, i);
        return result;
    }

  private:
    template <class>
    friend class blended_uniforms;

    MICA_HOST_DEVICE constexpr blended_uniforms(const std::remove_cvref_t<Vertices>& vertices, std::uint32_t index,
                                                std::uint32_t counter)
        : vertices_(vertices), index_(index), counter_(counter) {}

    Vertices vertices_;
    std::uint32_t index_;
    std::uint32_t counter_;
    bool has_second_ = false;
    number second_{};
};

/// Refers to the vertices that it is given.
template <class Vertices>
blended_uniforms(const Vertices&, std::uint32_t = 0) -> blended_uniforms<const Vertices&>;

} // namespace mica
