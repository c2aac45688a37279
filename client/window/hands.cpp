#include "client/window/hands.hpp"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <imgui.h>

#include <algorithm>
#include <numbers>

#include "client/window/overlay.hpp"

namespace iwalk::client {
namespace {

Hands& handsOf(GLFWwindow* window) {
    return *static_cast<Hands*>(glfwGetWindowUserPointer(window));
}

}  // namespace

// The overlay has put its callbacks in place already; ours call them first.
Hands::Hands(GLFWwindow* window, Flight& flight, Overlay& overlay)
    : window_(window), flight_(flight), overlay_(overlay) {
    glfwSetWindowUserPointer(window, this);
    glfwSetInputMode(window, GLFW_STICKY_KEYS, GLFW_TRUE);  // a short tap counts, too
    static GLFWkeyfun keyBefore;
    static GLFWmousebuttonfun buttonBefore;
    static GLFWscrollfun scrollBefore;
    static GLFWcursorposfun cursorBefore;
    keyBefore = glfwSetKeyCallback(window, [](GLFWwindow* w, int key, int code, int action, int modifiers) {
        if (keyBefore) keyBefore(w, key, code, action, modifiers);
        if (action == GLFW_PRESS && !ImGui::GetIO().WantTextInput) handsOf(w).key(key, modifiers);
    });
    buttonBefore =
        glfwSetMouseButtonCallback(window, [](GLFWwindow* w, int button, int action, int modifiers) {
            if (buttonBefore) buttonBefore(w, button, action, modifiers);
            if (action == GLFW_RELEASE || !ImGui::GetIO().WantCaptureMouse)
                handsOf(w).button(button, action == GLFW_PRESS);
        });
    scrollBefore = glfwSetScrollCallback(window, [](GLFWwindow* w, double x, double y) {
        if (scrollBefore) scrollBefore(w, x, y);
        if (!ImGui::GetIO().WantCaptureMouse) handsOf(w).flight_.changeSpeed(y);
    });
    cursorBefore = glfwSetCursorPosCallback(window, [](GLFWwindow* w, double x, double y) {
        if (cursorBefore) cursorBefore(w, x, y);
        handsOf(w).moved(x, y);
    });
}

Hands::~Hands() {
    glfwSetKeyCallback(window_, nullptr);
    glfwSetMouseButtonCallback(window_, nullptr);
    glfwSetScrollCallback(window_, nullptr);
    glfwSetCursorPosCallback(window_, nullptr);
}

Motion Hands::motion() const {
    Motion motion;
    const auto held = [&](int key) { return glfwGetKey(window_, key) == GLFW_PRESS ? 1.0 : 0.0; };
    motion.right = held(GLFW_KEY_D) - held(GLFW_KEY_A);
    motion.up = held(GLFW_KEY_E) - held(GLFW_KEY_Q);
    motion.forward = held(GLFW_KEY_W) - held(GLFW_KEY_S);
    motion.fast = held(GLFW_KEY_LEFT_SHIFT) + held(GLFW_KEY_RIGHT_SHIFT) > 0;
    // With Ctrl, or in a text, they mean something else.
    const bool other = held(GLFW_KEY_LEFT_CONTROL) + held(GLFW_KEY_RIGHT_CONTROL) > 0;
    return other || ImGui::GetIO().WantTextInput ? Motion() : motion;
}

void Hands::key(int key, int modifiers) {
    const bool control = modifiers & GLFW_MOD_CONTROL;
    if (key >= GLFW_KEY_0 && key <= GLFW_KEY_9) {
        const auto number = static_cast<std::size_t>(key == GLFW_KEY_0 ? 9 : key - GLFW_KEY_1);
        return control ? flight_.saveView(number) : flight_.recallView(number);
    }
    if (control && key == GLFW_KEY_Q) return glfwSetWindowShouldClose(window_, GLFW_TRUE);
    if (control) return;
    switch (key) {
        case GLFW_KEY_F1:
            return overlay_.toggleHelp();
        case GLFW_KEY_TAB:
            return overlay_.toggleSettings();
        case GLFW_KEY_ESCAPE:
            return overlay_.closePanels();
        case GLFW_KEY_HOME:
            return flight_.goHome();
        default:
            return letter(key);
    }
}

void Hands::letter(int key) {
    switch (key) {
        case GLFW_KEY_H:
            return overlay_.toggleHelp();
        case GLFW_KEY_O:
            return overlay_.toggleStatus();
        case GLFW_KEY_G:
            return flight_.toggleWalking();
        case GLFW_KEY_R:
            return flight_.toggleRecording();
        case GLFW_KEY_P:
            return flight_.toggleReplay();
        case GLFW_KEY_V:
            return flight_.togglePreview();
        case GLFW_KEY_C:
            return flight_.toggleControl();
        case GLFW_KEY_M:
            return flight_.changeToNext("mode");
        case GLFW_KEY_N:
            return flight_.changeToNext("show");
        default:
            return;
    }
}

void Hands::button(int button, bool down) {
    drag_ = Drag::none;
    if (!down) return;
    if (button == GLFW_MOUSE_BUTTON_LEFT) drag_ = Drag::look;
    if (button == GLFW_MOUSE_BUTTON_RIGHT) {
        drag_ = Drag::orbit;
        flight_.beginOrbit();
    }
}

// Looking: as far as the picture seems to move under the mouse. Orbiting: half around for the window's
// height.
void Hands::moved(double x, double y) {
    const double right = x - x_, up = y_ - y;
    x_ = x, y_ = y;
    if (drag_ == Drag::none || !flight_.navigator()) return;
    int width = 0, height = 1;
    glfwGetWindowSize(window_, &width, &height);
    const double perPixel = std::numbers::pi / std::max(height, 1);
    if (drag_ == Drag::orbit) return flight_.orbit(right * perPixel, up * perPixel);
    const double degrees = flight_.navigator()->camera().fovY / 180;
    flight_.turn(right * perPixel * degrees, up * perPixel * degrees);
}

}  // namespace iwalk::client
