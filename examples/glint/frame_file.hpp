// Frames and their tiles as files: PNG, toned, and OpenEXR, linear. Environments in OpenEXR.
#pragma once

#include <optional>
#include <string>

#include "render.hpp"

namespace glint {

/// An equirectangular map, channels R, G, B. Throws std::runtime_error, in one line, where it is none.
mica::environment_map read_exr_environment(const std::string& path);

/// A file for a frame. PNG is toned, and is of whole pictures: their exposure is. OpenEXR has R, G, B with glints, smooth.R,
/// smooth.G, smooth.B without and A = 1 where a surface is, all binary32; the display window is the whole picture, the data
/// window the tile. It appears under its name only when it is whole.
class frame_file {
  public:
    /// Throws std::runtime_error where the file cannot be written.
    explicit frame_file(const std::string& path);

    bool takes_tiles() const { return exr_.has_value(); }

    /// `origin` says what was asked for; tiles of one picture share it.
    void save(const frame& seen, const frame_statistics& statistics, const std::string& origin) const;

  private:
    std::optional<png_file> png_;
    std::optional<output_file> exr_;
};

struct frame_of_file {
    frame seen;
    std::string origin;
};

/// What frame_file wrote as OpenEXR. Throws std::runtime_error, in one line, where the file is something else.
frame_of_file read_frame(const std::string& path);

} // namespace glint
