// A GLFW window. Its GL context comes from GLX: NV_swap_group is GLX's.

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

class GlfwWindow : public WallWindow, public SwapGroupDriver {
  public:
    explicit GlfwWindow(const Tile& tile) : width_(tile.onScreen.width), height_(tile.onScreen.height) {}
    ~GlfwWindow() override {
        if (window_) glfwDestroyWindow(window_);
        glfwTerminate();
    }
    Result<void> open(const Tile& tile, const glm::ivec2& place);

    void show(std::uint32_t framebuffer) override;
    bool closed() override;
    SwapGroupDriver& swapGroupDriver() override { return *this; }
    bool join() override;
    void leave() override;

  private:
    Result<GLFWmonitor*> monitorNamed(const std::string& name) const;
    Result<void> checkSize() const;

    const int width_, height_;  // px
    GLFWwindow* window_ = nullptr;
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
    if (!glfwInit())
        return fail("cannot open the X display {}: {}; set DISPLAY, or 'display' in the wall file",
                    displayName(), glfwReason());
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
    window_ = glfwCreateWindow(width_, height_, tile.name.c_str(), monitor, nullptr);
    if (!window_) return fail("display {} gives no window with OpenGL 4.5: {}", displayName(), glfwReason());
    glfwMakeContextCurrent(window_);
    glfwSwapInterval(1);  // no picture changes while the screen is drawn
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
    glClear(GL_COLOR_BUFFER_BIT);
    glfwSwapBuffers(window_);
    return {};
}

void GlfwWindow::show(std::uint32_t framebuffer) {
    shown_ = framebuffer;
    glDisable(GL_SCISSOR_TEST);
    glBlitNamedFramebuffer(framebuffer, 0, 0, 0, width_, height_, 0, height_, width_, 0, GL_COLOR_BUFFER_BIT,
                           GL_NEAREST);
    glfwSwapBuffers(window_);
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

}  // namespace

Result<std::unique_ptr<WallWindow>> WallWindow::open(const Tile& tile, const glm::ivec2& place) {
    if (!tile.display.empty()) setenv("DISPLAY", tile.display.c_str(), 1);
    auto window = std::make_unique<GlfwWindow>(tile);
    RETURN_IF_ERROR(window->open(tile, place));
    return std::unique_ptr<WallWindow>(std::move(window));
}

}  // namespace iwalk
