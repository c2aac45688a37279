#pragma once

#include "client/fly/flight.hpp"

struct GLFWwindow;

namespace iwalk::client {

class Overlay;

// Keyboard and mouse of a window: what is held moves the camera, what is pressed is done.
class Hands {
  public:
    // All outlive this. The overlay's own callbacks stay in force.
    Hands(GLFWwindow* window, Flight& flight, Overlay& overlay);
    ~Hands();
    Hands(const Hands&) = delete;
    Hands& operator=(const Hands&) = delete;

    // Of the keys that are held now, or were since the last call.
    Motion motion() const;

  private:
    enum class Drag { none, look, orbit };
    void key(int key, int modifiers);
    void letter(int key);
    void button(int button, bool down);
    void moved(double x, double y);

    GLFWwindow* const window_;
    Flight& flight_;
    Overlay& overlay_;
    Drag drag_ = Drag::none;
    double x_ = 0, y_ = 0;  // of the mouse as events tell it, which may be late; window coordinates
};

}  // namespace iwalk::client
