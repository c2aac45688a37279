#include "client/fly/saved_views.hpp"

#include <gtest/gtest.h>

#include "common/file.hpp"
#include "tests/common/temp_directory.hpp"

namespace iwalk::client {
namespace {

const Camera kHome{{0, -9, 0}, {0, 0, 0}, {0, 0, 1}, 45};
const Camera kKitchen{{1, 2, 3}, {4, 5, 6}, {0, 1, 1}, 45};

TEST(SavedViews, ComeBackFromTheFile) {
    const TempDirectory directory;
    const std::string file = directory.path("views.json");
    auto views = SavedViews::open(file);
    ASSERT_TRUE(views.ok()) << views.error().message;
    EXPECT_FALSE(views->view(3));
    ASSERT_TRUE(views->save(3, kKitchen, kHome).ok());
    EXPECT_EQ(views->view(3), kKitchen);
    EXPECT_FALSE(views->view(2));

    const auto again = SavedViews::open(file);
    ASSERT_TRUE(again.ok());
    EXPECT_EQ(again->view(3), kKitchen);
    EXPECT_EQ(again->view(2), kHome);
    EXPECT_EQ(loadCameraPath(file)->size(), SavedViews::kViews);
}

TEST(SavedViews, FileHasOneFieldOfView) {
    const TempDirectory directory;
    const std::string file = directory.path("views.json");
    Camera wide = kKitchen;
    wide.fovY = 90;
    ASSERT_TRUE(saveCameraPath(file, {wide}).ok());
    auto views = SavedViews::open(file);
    ASSERT_TRUE(views.ok());
    ASSERT_TRUE(views->save(1, wide, kHome).ok());
    EXPECT_EQ(loadCameraPath(file)->at(0), kKitchen);
    EXPECT_EQ(loadCameraPath(file)->at(1), kKitchen);
}

TEST(SavedViews, DoNotOverwriteWhatIsSomethingElse) {
    const TempDirectory directory;
    const std::string file = directory.path("flight.json");
    ASSERT_TRUE(saveCameraPath(file, std::vector<Camera>(11, kHome)).ok());
    const auto flight = SavedViews::open(file);
    ASSERT_FALSE(flight.ok());
    EXPECT_NE(flight.error().message.find("11 frames"), std::string::npos);
    ASSERT_TRUE(replaceFile(file, "no JSON").ok());
    EXPECT_NE(SavedViews::open(file).error().message.find("flight.json"), std::string::npos);
}

TEST(SavedViews, APlaceThatCannotBeWritten) {
    auto views = SavedViews::open("/nonexistent/views.json");
    ASSERT_TRUE(views.ok());
    EXPECT_NE(views->save(0, kKitchen, kHome).error().message.find("/nonexistent"), std::string::npos);
}

}  // namespace
}  // namespace iwalk::client
