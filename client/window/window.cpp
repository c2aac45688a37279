#include "client/window/window.hpp"

#include <epoxy/gl.h>
// After it.
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <memory>

#include "client/fly/flight.hpp"
#include "client/window/hands.hpp"
#include "client/window/overlay.hpp"
#include "common/token.hpp"

namespace iwalk::client {
namespace {

constexpr int kWindowWidth = 1280, kWindowHeight = 800;
constexpr double kDrawSeconds = 1.0 / 30;     // between two drawings of the window; the wall has its own pace
constexpr double kRestSeconds = 0.25;         // between two looks when nothing happens
constexpr double kMotionSeconds = 1.0 / 120;  // and when something moves

std::string glfwTrouble() {
    const char* text = nullptr;
    glfwGetError(&text);
    return text ? text : "GLFW does not say why";
}

struct Terminate {
    void operator()(GLFWwindow* window) const {
        glfwDestroyWindow(window);
        glfwTerminate();
    }
};
using WindowPtr = std::unique_ptr<GLFWwindow, Terminate>;

Result<WindowPtr> openWindow(const std::string& title) {
    const auto trouble = [] {
        return fail("cannot open a window: {}; set DISPLAY, or play a path with --path", glfwTrouble());
    };
    if (!glfwInit()) return trouble();
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    WindowPtr window(glfwCreateWindow(kWindowWidth, kWindowHeight, title.c_str(), nullptr, nullptr));
    if (!window) {
        const Error error = trouble();
        glfwTerminate();
        return error;
    }
    glfwMakeContextCurrent(window.get());
    glfwSwapInterval(0);  // waiting for this display would delay the wall
    return window;
}

void draw(GLFWwindow* window, Overlay& overlay, Flight& flight) {
    int width = 0, height = 0;
    glfwGetFramebufferSize(window, &width, &height);
    glViewport(0, 0, width, height);
    glClearColor(0.07f, 0.08f, 0.09f, 1);
    glClear(GL_COLOR_BUFFER_BIT);
    overlay.draw(flight);
    glfwSwapBuffers(window);
}

void loop(GLFWwindow* window, Session& session, Flight& flight) {
    Overlay overlay(window);
    Hands hands(window, flight, overlay);
    double drawn = 0;
    bool moves = false;
    while (!glfwWindowShouldClose(window)) {
        glfwWaitEventsTimeout(moves ? kMotionSeconds : kRestSeconds);
        moves = flight.step(glfwGetTime(), hands.motion());
        overlay.takePreviews(session.previews(), flight.wall());
        if (glfwGetTime() - drawn < kDrawSeconds) continue;
        drawn = glfwGetTime();
        draw(window, overlay, flight);
    }
}

}  // namespace

Result<void> flyByHand(const Options& options) {
    ASSIGN_OR_RETURN(SavedViews views, SavedViews::open(options.views));
    const std::string server = fmt::format("{}:{}", options.server.host, options.server.port);
    protocol::Hello hello;
    hello.preview = options.preview;
    if (!options.tokenFile.empty()) {
        ASSIGN_OR_RETURN(hello.token, readToken(options.tokenFile));
    }
    ASSIGN_OR_RETURN(const WindowPtr window, openWindow(fmt::format("iWalk - {}", server)));
    Session session(options.server, hello, glfwPostEmptyEvent);
    Flight flight(options, session, std::move(views));
    loop(window.get(), session, flight);
    return flight.finish();
}

}  // namespace iwalk::client
