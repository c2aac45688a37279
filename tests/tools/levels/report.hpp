#pragma once

#include <string>
#include <vector>

#include "tests/tools/levels/cracks.hpp"
#include "tests/tools/levels/errors.hpp"
#include "tests/tools/levels/simplify_race.hpp"
#include "tests/tools/levels/views.hpp"

// What iwalk-levels prints, for people and as JSON.
namespace iwalk::levels {

double largestRatio(const std::vector<LevelErrors>& levels);

// `limit`: of the largest ratio of a distance and the stated error.
std::string errorsText(const std::vector<LevelErrors>& levels, double limit);
std::string errorsJson(const std::vector<LevelErrors>& levels, double limit);

std::string cracksText(const CrackReport& report, const CrackOptions& options);
std::string cracksJson(const CrackReport& report, const CrackOptions& options);

std::string viewsText(const ViewReport& report, const ViewOptions& options);
std::string viewsJson(const ViewReport& report, const ViewOptions& options);

std::string simplifyText(const std::vector<SimplifyRace>& levels);
std::string simplifyJson(const std::vector<SimplifyRace>& levels);

}  // namespace iwalk::levels
