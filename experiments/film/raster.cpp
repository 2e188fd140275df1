// SPDX-License-Identifier: Zlib
// Rasterises convex patches. Each row of pixels has one span of a convex patch, so a drawing library would be more code
// than this.
#include "experiments/film/raster.h"

#include <algorithm>
#include <cmath>

#include "experiments/film/png_file.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

constexpr int kSamples = 3;  // per pixel along each axis

DrawColour over(const DrawColour& c, const DrawColour& below) {
  const auto part = [&](int x, int y) { return static_cast<unsigned char>((x * c.alpha + y * (255 - c.alpha)) / 255); };
  return {part(c.red, below.red), part(c.green, below.green), part(c.blue, below.blue)};
}

class Raster {
 public:
  Raster(int width, int height)
      : m_width(width * kSamples),
        m_height(height * kSamples),
        m_samples(static_cast<std::size_t>(m_width * m_height)) {
    std::fill(m_samples.begin(), m_samples.end(), DrawColour{247, 247, 245});
  }

  void draw(const Patch& patch) {
    if (patch.corners.size() > 2) fill(patch.corners, patch.fill);
    for (std::size_t i = 0; i < patch.corners.size(); ++i) {
      line(patch.corners[i], patch.corners[(i + 1) % patch.corners.size()], patch.edge);
    }
  }

  std::vector<unsigned char> pixels() const {
    std::vector<unsigned char> out;
    out.reserve(m_samples.size() * 3 / (kSamples * kSamples));
    for (int y = 0; y < m_height; y += kSamples) {
      for (int x = 0; x < m_width; x += kSamples) {
        int red = 0, green = 0, blue = 0;
        for (int k = 0; k < kSamples * kSamples; ++k) {
          const DrawColour& c = m_samples[static_cast<std::size_t>((y + k / kSamples) * m_width + x + k % kSamples)];
          red += c.red, green += c.green, blue += c.blue;
        }
        for (const int sum : {red, green, blue}) out.push_back(static_cast<unsigned char>(sum / (kSamples * kSamples)));
      }
    }
    return out;
  }

 private:
  // Fills samples with the centre inside; the span of a row lies between the edges that cross it.
  void fill(const std::vector<Vec<2>>& corners, const DrawColour& colour) {
    double top = m_height, bottom = 0;
    for (const Vec<2>& c : corners) top = std::min(top, kSamples * c[1]), bottom = std::max(bottom, kSamples * c[1]);
    const int last = static_cast<int>(std::min<double>(m_height - 1, bottom));
    for (int y = static_cast<int>(std::max(0.0, top)); y <= last; ++y) {
      double left = m_width, right = -1;
      for (std::size_t i = 0; i < corners.size(); ++i) {
        const Vec<2> a = kSamples * corners[i], b = kSamples * corners[(i + 1) % corners.size()];
        if ((a[1] <= y + 0.5) == (b[1] <= y + 0.5)) continue;
        const double x = a[0] + (y + 0.5 - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
        left = std::min(left, x), right = std::max(right, x);
      }
      const int end = static_cast<int>(std::min<double>(m_width, std::floor(right + 0.5)));
      for (int x = static_cast<int>(std::max(0.0, std::ceil(left - 0.5))); x < end; ++x) {
        DrawColour& sample = m_samples[static_cast<std::size_t>(y * m_width + x)];
        sample = colour.alpha == 255 ? colour : over(colour, sample);
      }
    }
  }

  void line(const Vec<2>& a, const Vec<2>& b, const DrawColour& colour) {
    const Vec<2> along = b - a;
    if (along.norm() < 1e-9) return;
    const Vec<2> aside = 0.5 * Vec<2>(-along[1], along[0]) / along.norm();  // half a pixel to each side
    fill({a - aside, b - aside, b + aside, a + aside}, colour);
  }

  int m_width, m_height;
  std::vector<DrawColour> m_samples;
};

}  // namespace

void writePng(const std::string& path, const Picture& picture) {
  const int width = static_cast<int>(picture.width), height = static_cast<int>(picture.height);
  Raster raster(width, height);
  for (const Patch& p : picture.patches) raster.draw(p);
  writePng(path, width, height, raster.pixels());
}

}}  // namespace lpc::LPC_PRECISION
