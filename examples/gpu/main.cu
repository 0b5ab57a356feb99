// Glints on a GPU:  glint_gpu [--size WxH] [--levels 4|8] [-o FILE.ppm] [--time]
//
// Draws the scene of `glint render`, a sphere under the procedural sky, and checks it against the same code on the CPU:
//   - what leads to the counts (the pixel's facets, the probabilities of its classes) within 1e-4, relative: sine, arc
//     cosine and square root differ by the processors' libraries;
//   - counts of the same facets and probabilities are equal integers where nothing is fused (glint_gpu_exact: built with
//     -fmad=false), and else in all but one of a thousand pixels;
//   - the picture's radiance, from the same inputs, within 1e-4 where the counts are equal.
// --time tells milliseconds per frame at 3840x2160, for a plane that fills the picture, beside those of KK25, Table 1.
//
// Exit code: 0, 1 where a check fails, 2 where there is no GPU or an option is wrong.
//
// The filtered environment lies in plain arrays, so that both processors compute the same. An engine would keep it in
// textures: the K classes as layers of a cube map of half floats, its mip levels the roughnesses, and let the texture unit do
// the bilinear and trilinear part; and the microfacet table as one small texture.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include <mica/mica.hpp>

#include "../glint/scene.hpp"
#include "view.hpp"

namespace {

using law = mica::quantile_binomial<4>;
constexpr std::uint32_t seed = 1;

[[noreturn]] void stop(const char* what) {
    std::fprintf(stderr, "glint_gpu: %s\n", what);
    std::exit(2);
}

void check(cudaError_t status) {
    if (status != cudaSuccess) stop(cudaGetErrorString(status));
}

/// An array on the device.
template <class T>
class device_array {
  public:
    explicit device_array(std::size_t size) : size_(size) { check(cudaMalloc(&data_, size * sizeof(T))); }
    explicit device_array(const std::vector<T>& values) : device_array(values.size()) {
        check(cudaMemcpy(data_, values.data(), size_ * sizeof(T), cudaMemcpyHostToDevice));
    }
    ~device_array() { cudaFree(data_); }
    device_array(const device_array&) = delete;
    device_array& operator=(const device_array&) = delete;

    T* data() const { return data_; }
    std::vector<T> host() const {
        std::vector<T> values(size_);
        check(cudaMemcpy(values.data(), data_, size_ * sizeof(T), cudaMemcpyDeviceToHost));
        return values;
    }

  private:
    T* data_ = nullptr;
    std::size_t size_;
};

/// All that a pixel needs.
template <std::size_t K>
struct scene {
    view seen;
    mica::glint_material material;
    mica::prefiltered_classes_view<K> environment;
    const mica::microfacet_table* table;
};

/// A pixel's light and surface: floats that depend a little on the processor.
template <std::size_t K>
struct pixel_input {
    typename view::hit hit;
    std::array<mica::light_class<float>, K> classes;
};

/// What follows of them.
template <std::size_t K>
struct pixel_output {
    std::array<float, K> counts;
    mica::rgb<float> glint;
};

template <std::size_t K>
MICA_HOST_DEVICE pixel_input<K> input_of(const scene<K>& in, unsigned x, unsigned y) {
    pixel_input<K> pixel{in.seen(x, y), {}};
    if (pixel.hit.seen) pixel.classes = mica::light_classes(pixel.hit.point, in.material, in.environment, *in.table);
    return pixel;
}

template <std::size_t K>
MICA_HOST_DEVICE pixel_output<K> output_of(const pixel_input<K>& in, const mica::glint_material& material) {
    pixel_output<K> pixel{};
    if (!in.hit.seen) return pixel;
    const auto& point = in.hit.point;
    const auto footprint = mica::make_footprint(point.derivatives);
    const float facets = footprint.area * mica::exp(material.log_density);
    const auto vertices = mica::make_grid_vertices(footprint, point.uv, facets, seed, material.footprint_scale);
    std::array<float, K> probabilities{};
    for (std::size_t k = 0; k < K; ++k) probabilities[k] = in.classes[k].probability;
    pixel.counts = mica::distributed_multinomial<K, law, mica::blended_variates>{}(vertices, probabilities);
    pixel.glint = mica::glint_kernel<law>{}(point, material, in.classes, {}, seed).glint;
    return pixel;
}

template <std::size_t K>
__global__ void compute_inputs(scene<K> in, pixel_input<K>* inputs) {
    const unsigned x = blockIdx.x * blockDim.x + threadIdx.x, y = blockIdx.y * blockDim.y + threadIdx.y;
    if (x < in.seen.width && y < in.seen.height) inputs[std::size_t{y} * in.seen.width + x] = input_of(in, x, y);
}

template <std::size_t K>
__global__ void compute_outputs(const pixel_input<K>* inputs, mica::glint_material material, std::size_t pixels,
                                pixel_output<K>* outputs) {
    const std::size_t i = std::size_t{blockIdx.x} * blockDim.x + threadIdx.x;
    if (i < pixels) outputs[i] = output_of(inputs[i], material);
}

/// A frame as a renderer has it: nothing is kept but the picture. Kernel: with glints, or glint_kernel<no_glints>.
template <class Kernel, std::size_t K>
__global__ void render(scene<K> in, mica::rgb<float>* picture) {
    const unsigned x = blockIdx.x * blockDim.x + threadIdx.x, y = blockIdx.y * blockDim.y + threadIdx.y;
    if (x >= in.seen.width || y >= in.seen.height) return;
    const auto hit = in.seen(x, y);
    mica::rgb<float> radiance{0, 0, 0};
    if (hit.seen) radiance = mica::shade(Kernel{}, hit.point, in.material, in.environment, *in.table, seed).glint;
    picture[std::size_t{y} * in.seen.width + x] = radiance;
}

constexpr unsigned side = 16; // of a block of threads
dim3 blocks_of(const view& seen) { return {(seen.width + side - 1) / side, (seen.height + side - 1) / side}; }

/// The sky, filtered on the host: once there, once on the device.
template <std::size_t K>
class prepared_sky {
  public:
    explicit prepared_sky(const mica::glint_material& material)
        : host_(filtered(material)), host_maps_(views_of(host_.maps())),
          table_(std::make_unique<mica::microfacet_table>()),
          device_table_(std::vector<mica::microfacet_table>{*table_}) {
        std::vector<map> on_device;
        for (const auto& one : host_.maps()) {
            texels_.push_back(std::make_unique<device_array<value>>(one.image.texels));
            on_device.push_back(
                {one.roughness,
                 {one.image.width, one.image.height, {texels_.back()->data(), one.image.texels.size()}}});
        }
        device_maps_ = std::make_unique<device_array<map>>(on_device);
    }

    scene<K> on_host(const view& seen, const mica::glint_material& material) const {
        return {seen, material, {{host_maps_.data(), host_maps_.size()}}, table_.get()};
    }
    scene<K> on_device(const view& seen, const mica::glint_material& material) const {
        return {seen, material, {{device_maps_->data(), host_maps_.size()}}, device_table_.data()};
    }

  private:
    using value = typename mica::prefiltered_classes<K>::value_type;
    using map = typename mica::prefiltered_classes_view<K>::map;

    static mica::prefiltered_classes<K> filtered(const mica::glint_material& material) {
        const auto sky = glint::procedural_environment();
        const std::array roughnesses{material.roughness};
        return {sky, mica::environment_classes<K>::by_brightness(sky), roughnesses};
    }

    template <class Maps>
    static std::vector<map> views_of(const Maps& maps) {
        std::vector<map> views;
        for (const auto& one : maps)
            views.push_back({one.roughness, {one.image.width, one.image.height, one.image.texels}});
        return views;
    }

    mica::prefiltered_classes<K> host_;
    std::vector<map> host_maps_;
    std::unique_ptr<mica::microfacet_table> table_;
    device_array<mica::microfacet_table> device_table_;
    std::vector<std::unique_ptr<device_array<value>>> texels_;
    std::unique_ptr<device_array<map>> device_maps_;
};

/// The largest difference, relative to the values or, where they are smaller, to `scale`.
class largest_difference {
  public:
    void see(float a, float b, float scale) {
        const float size = std::max({std::abs(a), std::abs(b), scale});
        const float apart = std::abs(a - b) / size;
        if (!(apart <= value_)) value_ = apart; // NaN, too
    }
    float value() const { return value_; }

  private:
    float value_ = 0;
};

/// Whether a share of pixels at most `allowed` is different; says so.
bool few(const char* what, std::size_t different, std::size_t pixels, double allowed) {
    std::printf("%-40s differ in %zu of %zu pixels (at most %g allowed)\n", what, different, pixels, allowed);
    return static_cast<double>(different) <= allowed * static_cast<double>(pixels);
}

template <std::size_t K>
bool draw(const view& seen, const std::string& file) {
    const mica::glint_material material;
    const prepared_sky<K> sky(material);
    const std::size_t pixels = std::size_t{seen.width} * seen.height;
    const device_array<pixel_input<K>> inputs(pixels);
    const device_array<pixel_output<K>> outputs(pixels);
    compute_inputs<<<blocks_of(seen), dim3(side, side)>>>(sky.on_device(seen, material), inputs.data());
    constexpr unsigned threads = 128;
    const auto blocks = static_cast<unsigned>((pixels + threads - 1) / threads);
    compute_outputs<<<blocks, threads>>>(inputs.data(), material, pixels, outputs.data());
    check(cudaGetLastError());
    check(cudaDeviceSynchronize());
    const auto device_inputs = inputs.host();
    const auto device_outputs = outputs.host();

    constexpr float tolerance = 1e-4F;
    std::size_t input_differs = 0, count_differs = 0, radiance_differs = 0, on_surface = 0;
    for (unsigned y = 0; y < seen.height; ++y)
        for (unsigned x = 0; x < seen.width; ++x) {
            const std::size_t i = std::size_t{y} * seen.width + x;
            const auto& theirs = device_inputs[i];
            const auto ours = input_of(sky.on_host(seen, material), x, y);
            if (theirs.hit.seen != ours.hit.seen) {
                ++input_differs;
                continue;
            }
            if (!ours.hit.seen) continue;
            ++on_surface;
            largest_difference input;
            const auto& point = theirs.hit.point;
            input.see(point.uv.u, ours.hit.point.uv.u, 1);
            input.see(point.uv.v, ours.hit.point.uv.v, 1);
            input.see(mica::make_footprint(point.derivatives).area,
                      mica::make_footprint(ours.hit.point.derivatives).area, 0);
            for (std::size_t k = 0; k < K; ++k) {
                input.see(theirs.classes[k].probability, ours.classes[k].probability, 1);
                input.see(mica::luminance(theirs.classes[k].smooth), mica::luminance(ours.classes[k].smooth), 1e-3F);
            }
            if (!(input.value() <= tolerance)) ++input_differs;

            const auto expected = output_of(theirs, material);
            const auto& found = device_outputs[i];
            if (found.counts != expected.counts) {
                ++count_differs;
                continue;
            }
            largest_difference radiance;
            radiance.see(found.glint.r, expected.glint.r, 1e-3F);
            radiance.see(found.glint.g, expected.glint.g, 1e-3F);
            radiance.see(found.glint.b, expected.glint.b, 1e-3F);
            if (!(radiance.value() <= tolerance)) ++radiance_differs;
        }
#if MICA_EXAMPLE_EXACT
    const double counts_allowed = 0;
#else
    const double counts_allowed = 1e-3;
#endif
    std::printf("%ux%u, K = %zu, %zu pixels on the surface\n", seen.width, seen.height, K, on_surface);
    bool right = on_surface > 0;
    // At the edge of the sphere a ray grazes it, and derivatives are of any size.
    right = few("facets, probabilities, smooth radiance", input_differs, on_surface, 5e-3) && right;
    right = few("counts", count_differs, on_surface, counts_allowed) && right;
    right = few("radiance where counts are equal", radiance_differs, on_surface, 0) && right;

    if (!file.empty()) {
        std::FILE* const out = std::fopen(file.c_str(), "wb");
        if (!out) stop(("cannot write " + file).c_str());
        std::fprintf(out, "P6\n%u %u\n255\n", seen.width, seen.height);
        for (const auto& one : device_outputs)
            for (const float band : std::array{one.glint.r, one.glint.g, one.glint.b})
                std::fputc(static_cast<int>(255 * std::pow(std::min(band / (1 + band), 1.F), 1 / 2.2F)), out);
        std::fclose(out);
    }
    return right;
}

/// Milliseconds of a frame: the median of many, after some that are not counted.
template <class Kernel, std::size_t K>
float milliseconds(const scene<K>& in) {
    const device_array<mica::rgb<float>> picture(std::size_t{in.seen.width} * in.seen.height);
    cudaEvent_t start, end;
    check(cudaEventCreate(&start));
    check(cudaEventCreate(&end));
    std::vector<float> times;
    constexpr int warm_up = 20, frames = 200;
    for (int i = 0; i < warm_up + frames; ++i) {
        check(cudaEventRecord(start));
        render<Kernel><<<blocks_of(in.seen), dim3(side, side)>>>(in, picture.data());
        check(cudaEventRecord(end));
        check(cudaEventSynchronize(end));
        float time = 0;
        check(cudaEventElapsedTime(&time, start, end));
        if (i >= warm_up) times.push_back(time);
    }
    check(cudaGetLastError());
    cudaEventDestroy(start);
    cudaEventDestroy(end);
    std::nth_element(times.begin(), times.begin() + frames / 2, times.end());
    return times[frames / 2];
}

template <std::size_t K>
void print_times(const char* published) {
    const mica::glint_material material;
    const prepared_sky<K> sky(material);
    const auto in = sky.on_device({false, 3840, 2160}, material);
    const float smooth = milliseconds<mica::glint_kernel<mica::no_glints>>(in);
    const float glints = milliseconds<mica::glint_kernel<law>>(in);
    std::printf("| %zu | %.3f | %.3f | %.3f | %s |\n", K, static_cast<double>(smooth), static_cast<double>(glints),
                static_cast<double>(glints - smooth), published);
}

} // namespace

int main(int arguments, char** argument) {
    view seen{true, 960, 540};
    std::string file;
    unsigned levels = 0;
    bool time = false;
    for (int i = 1; i < arguments; ++i) {
        const std::string option = argument[i];
        const char* const value = i + 1 < arguments ? argument[i + 1] : "";
        if (option == "--time") {
            time = true;
            continue;
        }
        char rest = 0;
        if (option == "-o" && *value)
            file = value;
        else if (option == "--size" && std::sscanf(value, "%ux%u%c", &seen.width, &seen.height, &rest) == 2 &&
                 seen.width >= 1 && seen.width <= 16384 && seen.height >= 1 && seen.height <= 16384)
            ;
        else if (option == "--levels" && (!std::strcmp(value, "4") || !std::strcmp(value, "8")))
            levels = value[0] == '4' ? 4 : 8;
        else
            stop("options: [--size WxH] [--levels 4|8] [-o FILE.ppm] [--time]");
        ++i;
    }

    int devices = 0;
    if (cudaGetDeviceCount(&devices) != cudaSuccess || devices == 0) stop("no GPU that CUDA can use");
    cudaDeviceProp properties{};
    check(cudaGetDeviceProperties(&properties, 0));
    std::printf("%s\n", properties.name);

    bool right = true;
    if (levels != 8) right = draw<4>(seen, file) && right;
    if (levels != 4) right = draw<8>(seen, levels == 8 ? file : "") && right;
    if (time) {
        std::printf(
            "\nms per frame, 3840x2160, a plane fills the picture, static environment; KK25 Table 1, RTX 4090\n");
        std::printf(
            "| K | smooth | glints | over smooth | KK25: smooth, glints, over smooth |\n|---|---|---|---|---|\n");
        print_times<4>("1.5, 2.4, 0.9");
        print_times<8>("1.5, 6.3, 4.8");
    }
    return right ? 0 : 1;
}
