// Any bytes as an OpenEXR file of glint's, a tile or an environment map: it is read, or refused. OpenEXR itself
// is not instrumented; what it writes into our memory is watched.
#include <stdexcept>

#include <frame_file.hpp>

#include "file_in_memory.hpp"
#include "input.hpp"

namespace {

template <class Read>
void read_or_refuse(const Read& read) {
    try {
        read();
    } catch (
        const std::runtime_error&) { // it says what is wrong; main() makes one line of it, whatever names it quotes
    } catch (const std::invalid_argument&) {
    }
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const file_in_memory file(data, size);
    read_or_refuse([&] {
        const auto read = glint::read_frame(file.path());
        const auto& tile = read.seen.tile;
        require(tile.left + tile.width <= read.seen.width && tile.top + tile.height <= read.seen.height,
                "a tile is in its picture");
        require(read.seen.shows_surface.size() == tile.area(), "every pixel is there");
        glint::statistics_of(read.seen);
    });
    read_or_refuse([&] {
        const auto map = glint::read_exr_environment(file.path());
        require(map.image().width == 2 * map.image().height, "a map is twice as wide as high");
    });
    return 0;
}
