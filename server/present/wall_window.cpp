// GLFW windows. Their GL contexts come from GLX: NV_swap_group is GLX's.

#include "server/present/wall_window.hpp"

#include <epoxy/gl.h>
#include <epoxy/glx.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <cstdlib>

namespace iwalk {
namespace {

constexpr GLuint kSwapGroup = 1, kSwapBarrier = 1;

std::string displayName() {
    const char* name = std::getenv("DISPLAY");
    return name && *name ? name : "(none: DISPLAY is not set)";
}

std::string glfwReason() {
    const char* reason = nullptr;
    glfwGetError(&reason);
    return reason ? reason : "no reason given";
}

// GLFW, which opens one display in a process.
class Glfw {
  public:
    ~Glfw() { glfwTerminate(); }
    Result<void> open() {
        if (glfwInit()) return {};
        return fail("cannot open the X display {}: {}; set DISPLAY, or 'display' in the wall file",
                    displayName(), glfwReason());
    }
};

class GlfwWindow : public WallWindow, public SwapGroupDriver {
  public:
    // `drawing`: the window whose context draws; null: this one's does.
    GlfwWindow(const Tile& tile, GLFWwindow* drawing)
        : width_(tile.onScreen.width), height_(tile.onScreen.height), drawing_(drawing) {}
    ~GlfwWindow() override {
        if (window_) glfwDestroyWindow(window_);
    }
    Result<void> open(const Tile& tile, const glm::ivec2& place);
    GLFWwindow* handle() const { return window_; }

    void show(std::uint32_t texture) override;
    bool closed() override;
    SwapGroupDriver& swapGroupDriver() override { return *this; }
    bool join() override;
    void leave() override;

  private:
    Result<GLFWmonitor*> monitorNamed(const std::string& name) const;
    Result<void> checkSize() const;

    const int width_, height_;  // px
    GLFWwindow* const drawing_;
    GLFWwindow* window_ = nullptr;
    GLuint framebuffer_ = 0;  // of the window's context, and gone with it
    GLuint shown_ = 0;
    bool lost_ = false;     // the display has forgotten some of the picture
    bool grouped_ = false;  // a swap waits for all others
};

Result<GLFWmonitor*> GlfwWindow::monitorNamed(const std::string& name) const {
    int count = 0;
    GLFWmonitor** monitors = glfwGetMonitors(&count);
    std::string names;
    for (int i = 0; i < count; ++i) {
        const std::string known = glfwGetMonitorName(monitors[i]);
        names += fmt::format("{}{}", names.empty() ? "" : ", ", known);
        if (known != name) continue;
        const GLFWvidmode* mode = glfwGetVideoMode(monitors[i]);
        if (mode->width == width_ && mode->height == height_) return monitors[i];
        return fail(
            "monitor {} of display {} shows {}x{} px, but its tile has {}x{}: give the wall file the tile's "
            "size, "
            "or the monitor another mode (xrandr)",
            name, displayName(), mode->width, mode->height, width_, height_);
    }
    return fail("display {} has no monitor '{}', but: {}", displayName(), name,
                names.empty() ? "none" : names);
}

// Of window managers, some cut a window to their screen.
Result<void> GlfwWindow::checkSize() const {
    int width = 0, height = 0;
    glfwGetFramebufferSize(window_, &width, &height);
    if (width == width_ && height == height_) return {};
    return fail("the window has {}x{} px on display {}, but its tile {}x{}: is the display large enough?",
                width, height, displayName(), width_, height_);
}

Result<void> GlfwWindow::open(const Tile& tile, const glm::ivec2& place) {
    GLFWmonitor* monitor = nullptr;
    if (!tile.monitor.empty()) {
        ASSIGN_OR_RETURN(monitor, monitorNamed(tile.monitor));
    }
    const std::pair<int, int> hints[] = {{GLFW_CONTEXT_VERSION_MAJOR, 4},
                                         {GLFW_CONTEXT_VERSION_MINOR, 5},
                                         {GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE},
                                         {GLFW_DECORATED, GLFW_FALSE},
                                         {GLFW_RESIZABLE, GLFW_FALSE},
                                         {GLFW_AUTO_ICONIFY, GLFW_FALSE},
                                         {GLFW_VISIBLE, GLFW_FALSE},
                                         {GLFW_DEPTH_BITS, 0},
                                         {GLFW_STENCIL_BITS, 0},
                                         {GLFW_ALPHA_BITS, 0}};
    for (const auto& [hint, value] : hints) glfwWindowHint(hint, value);
    window_ = glfwCreateWindow(width_, height_, tile.name.c_str(), monitor, drawing_);
    if (!window_) return fail("display {} gives no window with OpenGL 4.5: {}", displayName(), glfwReason());
    glfwMakeContextCurrent(window_);
    // The first of a rank waits for the refresh, so that no picture changes while the screen is drawn.
    glfwSwapInterval(drawing_ ? 0 : 1);
    glfwSetWindowUserPointer(window_, this);
    glfwSetWindowRefreshCallback(window_, [](GLFWwindow* window) {
        static_cast<GlfwWindow*>(glfwGetWindowUserPointer(window))->lost_ = true;
    });
    glfwSetInputMode(window_, GLFW_CURSOR, GLFW_CURSOR_HIDDEN);
    glfwSetInputMode(window_, GLFW_STICKY_KEYS, GLFW_TRUE);  // no key is too short
    if (!monitor) glfwSetWindowPos(window_, place.x, place.y);
    glfwShowWindow(window_);
    glfwPollEvents();
    RETURN_IF_ERROR(checkSize());
    glCreateFramebuffers(1, &framebuffer_);
    glClear(GL_COLOR_BUFFER_BIT);
    glfwSwapBuffers(window_);
    if (drawing_) glfwMakeContextCurrent(drawing_);
    return {};
}

// What was drawn is finished. Attaching the texture anew lets another context see what has become of it.
void GlfwWindow::show(std::uint32_t texture) {
    shown_ = texture;
    if (drawing_) glfwMakeContextCurrent(window_);
    glNamedFramebufferTexture(framebuffer_, GL_COLOR_ATTACHMENT0, texture, 0);
    glDisable(GL_SCISSOR_TEST);
    glBlitNamedFramebuffer(framebuffer_, 0, 0, 0, width_, height_, 0, height_, width_, 0, GL_COLOR_BUFFER_BIT,
                           GL_NEAREST);
    glfwSwapBuffers(window_);
    if (drawing_) glfwMakeContextCurrent(drawing_);
}

bool GlfwWindow::closed() {
    glfwPollEvents();
    if (lost_ && shown_ != 0 && !grouped_) show(shown_);
    lost_ = false;
    return glfwWindowShouldClose(window_) || glfwGetKey(window_, GLFW_KEY_ESCAPE) == GLFW_PRESS;
}

bool GlfwWindow::join() {
    Display* display = glXGetCurrentDisplay();
    if (!epoxy_has_glx_extension(display, DefaultScreen(display), "GLX_NV_swap_group")) return false;
    const GLXDrawable drawable = glXGetCurrentDrawable();
    if (!glXJoinSwapGroupNV(display, drawable, kSwapGroup)) return false;
    grouped_ = glXBindSwapBarrierNV(display, kSwapGroup, kSwapBarrier);
    if (!grouped_) leave();
    return grouped_;
}

void GlfwWindow::leave() {
    Display* display = glXGetCurrentDisplay();
    grouped_ = false;
    glXBindSwapBarrierNV(display, kSwapGroup, 0);
    glXJoinSwapGroupNV(display, glXGetCurrentDrawable(), 0);
}

class GlfwWindows : public WallWindows {
  public:
    Result<void> open(const std::vector<Place>& places);
    WallWindow& window(std::size_t i) override { return *windows_[i]; }

  private:
    Glfw glfw_;  // outlives the windows
    std::vector<std::unique_ptr<GlfwWindow>> windows_;
};

std::string displayOf(const Tile& tile) {
    return wholeDisplayName(tile.display.empty() ? displayName() : tile.display);
}

Result<void> GlfwWindows::open(const std::vector<Place>& places) {
    const Tile& first = places.at(0).tile;
    for (const Place& place : places)
        if (displayOf(place.tile) != displayOf(first))
            return fail(
                "tiles '{}' and '{}' belong to one rank, which has one X display, but are on {} and {}: "
                "start a rank for each display",
                first.name, place.tile.name, displayOf(first), displayOf(place.tile));
    if (!first.display.empty()) setenv("DISPLAY", first.display.c_str(), 1);
    RETURN_IF_ERROR(glfw_.open());
    for (const Place& place : places) {
        GLFWwindow* const drawing = windows_.empty() ? nullptr : windows_[0]->handle();
        windows_.push_back(std::make_unique<GlfwWindow>(place.tile, drawing));
        RETURN_IF_ERROR(windows_.back()->open(place.tile, place.at));
    }
    return {};
}

}  // namespace

std::string wholeDisplayName(const std::string& name) {
    const std::size_t colon = name.rfind(':');
    if (colon == std::string::npos || name.find('.', colon) != std::string::npos) return name;
    return name + ".0";
}

Result<std::unique_ptr<WallWindows>> WallWindows::open(const std::vector<Place>& places) {
    auto windows = std::make_unique<GlfwWindows>();
    RETURN_IF_ERROR(windows->open(places));
    return std::unique_ptr<WallWindows>(std::move(windows));
}

}  // namespace iwalk
