#pragma once

#include <cmath>
#include <glm/vec3.hpp>

#include "common/geometry.hpp"

namespace iwalk {

// The eye on the dataset's lattice: a cell, and where in it. Positions relative to the eye are made from the
// integer difference to `cell` first, so that they are exact however far from the origin the model lies.
struct LatticeEye {
    LatticePoint cell{0};
    glm::dvec3 fraction{
        0};  // [0, 1) steps, a multiple of 2^-16: sums with differences up to 2^36 steps are exact

    // `model`: model units; one lattice step is 2^stepExponent of them.
    static LatticeEye at(const glm::dvec3& model, int stepExponent) {
        const glm::dvec3 steps(std::ldexp(model.x, -stepExponent), std::ldexp(model.y, -stepExponent),
                               std::ldexp(model.z, -stepExponent));
        LatticeEye eye;
        for (glm::length_t axis = 0; axis < 3; ++axis) {
            // An eye outside the lattice (2^62 steps) sees the model as a point anyway.
            const double bounded = std::fmin(std::fmax(steps[axis], -0x1p62), 0x1p62);
            const double cell = std::floor(bounded);
            eye.cell[axis] = static_cast<std::int64_t>(cell);
            eye.fraction[axis] = std::floor((bounded - cell) * 0x1p16) * 0x1p-16;
        }
        return eye;
    }

    // From the eye to a lattice point, in steps.
    glm::dvec3 to(const LatticePoint& p) const {
        return glm::dvec3(static_cast<double>(p.x - cell.x), static_cast<double>(p.y - cell.y),
                          static_cast<double>(p.z - cell.z)) -
               fraction;
    }
};

}  // namespace iwalk
