#pragma once

#include <vector>

#include "preprocess/import/importer.hpp"

namespace iwalk {

// Turns the corners of polygons, one after the other, into triangles for the sink, in batches: fans from the
// first corner. Drops and counts triangles whose positions are not finite; puts the face's normal where a
// corner has none.
class TriangleOutput {
  public:
    // `normals`: the input has normals, so every corner must get one. `sink` must outlive this.
    TriangleOutput(bool normals, const TriangleSink& sink);

    // Starts a polygon.
    void begin() { corners_ = 0; }
    // Its next corner.
    Result<void> corner(const Corner& corner);
    // The quick way for what is a triangle: fill in all of next(), then add() it.
    Triangle& next() { return batch_[size_]; }
    Result<void> add();
    // Hands on what is left. Call at the end.
    Result<void> flush();

    const ImportCounts& counts() const { return counts_; }

  private:
    static constexpr std::size_t kBatch = 4096;  // triangles of 120 bytes
    bool normals_;
    const TriangleSink& sink_;
    std::size_t corners_ = 0;  // of the polygon under way; stops counting at 2
    Corner first_, previous_;
    std::vector<Triangle> batch_ = std::vector<Triangle>(kBatch);
    std::size_t size_ = 0;  // triangles in the batch
    ImportCounts counts_;
};

}  // namespace iwalk
