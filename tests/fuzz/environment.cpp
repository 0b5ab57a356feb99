// Any bytes as an environment map of glint's: it is read, or refused in one line. What is read is parted into levels and
// classes, filtered and looked up in any direction, and gives finite radiances.
#include <cmath>
#include <stdexcept>

#include <picture.hpp>

#include <mica/shade/prefilter.hpp>

#include "file_in_memory.hpp"
#include "input.hpp"

namespace {

void require_sum_of_one(const std::array<float, 3>& parts) {
    float sum = 0;
    for (const float part : parts) {
        require(part >= -1e-5F, "a share is at least 0", static_cast<double>(part));
        sum += part;
    }
    require(std::abs(sum - 1) < 1e-3F, "shares sum to 1", static_cast<double>(sum));
}

void look_up(const mica::environment_map& map, mica::vector3<float> towards) {
    const float seen = luminance(map(towards));
    require(seen >= 0 && std::isfinite(seen), "a radiance is finite", static_cast<double>(seen));
}

void filter(const mica::environment_map& map, mica::vector3<float> towards, float roughness) {
    constexpr mica::prefilter_quality coarse{4, 2, 1, 1};
    const std::array<float, 2> roughnesses{0.1F, 0.5F};
    const mica::environment_levels<3> levels(map);
    const auto level =
        mica::prefiltered_environment<3>(map, levels, roughnesses, mica::serial_loop{}, coarse)(towards, roughness);
    require(std::isfinite(luminance(level.radiance)), "a filtered radiance is finite");
    require_sum_of_one(level.indicator);
    for (const auto& classes :
         {mica::environment_classes<3>::by_brightness(map), mica::environment_classes<3>::by_colour(map)}) {
        const auto lobe = mica::prefiltered_classes<3>(map, classes, roughnesses, mica::all_visible{},
                                                       mica::serial_loop{}, coarse)(towards, roughness);
        for (const auto& radiance : lobe.radiance)
            require(std::isfinite(luminance(radiance)), "a filtered radiance is finite");
        require_sum_of_one(lobe.share);
    }
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const file_in_memory file(data, size);
    try {
        const auto map = glint::read_environment(file.path());
        require(map.image().width == 2 * map.image().height, "a map is twice as wide as high");
        // A direction of the last bytes, any bits.
        input last(data + (size > 16 ? size - 16 : 0), size > 16 ? 16 : size);
        const mica::vector3<float> towards{last.take<float>(), last.take<float>(), last.take<float>()};
        look_up(map, towards);
        look_up(map, {0, 1, 0});
        if (map.image().texels.size() <= 512) {
            filter(map, {0, 0.6F, 0.8F}, 0.2F);
            filter(map, towards, last.take<float>());
        }
    } catch (const std::runtime_error& error) {
        const std::string line = error.what();
        require(!line.empty() && line.find('\n') == std::string::npos, "an error is one line");
    } catch (const std::invalid_argument& error) {
        require(std::string(error.what()).find('\n') == std::string::npos, "an error is one line");
    }
    return 0;
}
