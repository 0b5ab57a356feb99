// Tiles of one picture put together.

#include <cstdio>
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "frame_file.hpp"

namespace glint {

namespace {

/// Puts tiles into the whole picture. Every pixel comes from one tile.
class assembly {
  public:
    void add(const std::string& path) {
        const auto [part, origin] = read_frame(path);
        if (tiles_.empty()) {
            whole_ = frame(part.width, part.height, {0, 0, part.width, part.height});
            tile_of_.assign(whole_.tile.area(), none);
            origin_ = origin;
        }
        if (origin != origin_ || part.width != whole_.width || part.height != whole_.height)
            throw file_error(path, "is of another picture than " + tiles_.front());
        for (std::size_t y = 0; y < part.tile.height; ++y)
            for (std::size_t x = 0; x < part.tile.width; ++x) {
                const std::size_t from = y * part.tile.width + x;
                const std::size_t to = (part.tile.top + y) * whole_.width + part.tile.left + x;
                if (tile_of_[to] != none) throw file_error(path, "overlaps " + tiles_[tile_of_[to]]);
                tile_of_[to] = tiles_.size();
                whole_.glint.pixels[to] = part.glint.pixels[from];
                whole_.smooth.pixels[to] = part.smooth.pixels[from];
                whole_.shows_surface[to] = part.shows_surface[from];
            }
        tiles_.push_back(path);
    }

    const std::string& origin() const { return origin_; }

    /// Throws std::runtime_error where a tile is missing.
    const frame& whole() const {
        for (std::size_t i = 0; i < tile_of_.size(); ++i)
            if (tile_of_[i] == none)
                throw std::runtime_error("no tile has pixel " + std::to_string(i % whole_.width) + "," +
                                         std::to_string(i / whole_.width));
        return whole_;
    }

  private:
    static constexpr std::size_t none = static_cast<std::size_t>(-1);

    frame whole_{0, 0, {}};
    std::string origin_;
    std::vector<std::string> tiles_;
    std::vector<std::size_t> tile_of_; ///< of every pixel, its number
};

} // namespace

void merge(const merge_options& options) {
    const frame_file output(options.output);
    assembly parts;
    for (const auto& path : options.tiles) parts.add(path);
    const frame& whole = parts.whole();
    const frame_statistics seen = statistics_of(whole);
    output.save(whole, seen, parts.origin());
    if (options.json) {
        const nlohmann::ordered_json row = {{"width", whole.width},
                                            {"height", whole.height},
                                            {"tiles", options.tiles.size()},
                                            {"surface_pixels", seen.surface_pixels},
                                            {"non_finite_pixels", seen.non_finite_pixels},
                                            {"mean_glint", seen.mean_glint},
                                            {"mean_smooth", seen.mean_smooth},
                                            {"output", options.output}};
        std::printf("%s\n", row.dump(1).c_str());
    } else {
        std::printf("%s: %zux%zu from %zu tiles; mean luminance %.4g with glints, %.4g smooth\n",
                    options.output.c_str(), whole.width, whole.height, options.tiles.size(), seen.mean_glint,
                    seen.mean_smooth);
    }
}

} // namespace glint
