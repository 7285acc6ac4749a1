#include "method/check_options.h"

#include <raymap/error.h>

#include <cmath>
#include <string>

#include "base/require.h"
#include "field/field_sampler.h"

namespace raymap {

void checkOptions(const FieldOptions& options) {
  requireKnown(options.distance, DistanceMode::Raster, "distance mode");
  requireKnown(options.sign, SignMode::None, "sign mode");
  requireKnown(options.sampling, Sampling::Paper, "sampling");
  requireKnown(options.orientation, Orientation::Repair, "orientation");
  require(options.band >= 0.0, "the band must not be negative");
  require(options.passes >= 1, "the number of passes must be 1 or more");
  require(options.threshold >= 0.0, "the threshold must not be negative");
  require(!options.closeHoles || options.sign != SignMode::None, "closing holes needs a sign");
  require(
      options.sign != SignMode::None || options.thickness > 0.0 || !(options.winding || options.confidence),
      "winding numbers and confidences need a sign; leave them out, or choose a sign mode");
  require(options.thickness >= 0.0 && std::isfinite(options.thickness), "the thickness must not be negative");
  require(options.thickness == 0.0 || !(options.winding || options.confidence || options.closeHoles),
          "a thickness takes the place of the sign: leave out winding, confidence and closing holes");
  require(!options.triangle || options.distance != DistanceMode::Raster,
          "the raster distance does not find closest triangles; use another distance");
}

void checkOptions(const Grid& grid, const FieldOptions& options) {
  validateGrid(grid);
  checkOptions(options);
  require(grid.sampleCount() < kNoTriangle,
          "the grid has " + std::to_string(grid.sampleCount()) +
              " samples; at most 4294967294 can be numbered, use a lower resolution");
}

}  // namespace raymap
