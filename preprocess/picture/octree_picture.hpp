#pragma once

#include <string>

#include "common/image.hpp"

namespace iwalk {

// What is drawn of a dataset.
struct OctreePicture {
    ColorImage image;
    unsigned level = 0;                    // of the model; kFullLevel
    unsigned shallowest = 0, deepest = 0;  // depths of leaves
};

// The model from above at an angle, parallel projection, and over it the edges of the cells of the octree's
// leaves, from blue (shallow) to red (deep), with a legend. The model is drawn at the coarsest level whose
// error is below half a pixel. Reads page after page; memory is the hierarchy's, two pages' and the
// picture's.
Result<OctreePicture> drawOctree(const std::string& dataset, int width, int height);

}  // namespace iwalk
