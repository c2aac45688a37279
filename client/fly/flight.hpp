#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "client/fly/navigator.hpp"
#include "client/fly/recorder.hpp"
#include "client/fly/saved_views.hpp"
#include "client/fly/session.hpp"
#include "client/options.hpp"

namespace iwalk::client {

// What a person does with the wall, whatever window the wishes come from. Times are seconds of any clock.
class Flight {
  public:
    // `session` outlives this.
    Flight(const Options& options, Session& session, SavedViews views);

    // Looks at what the servers say and moves on; the camera goes out when it has changed. True while
    // something moves by itself or by `wanted`.
    bool step(double now, const Motion& wanted);

    // What the last step() saw. Before anything is known of a wall there is no navigator.
    const WallState& wall() const { return wall_; }
    const Navigator* navigator() const { return navigator_ ? &*navigator_ : nullptr; }
    bool steers() const { return navigator_ && wall_.connected && wall_.control; }
    bool recording() const { return recording_; }
    std::size_t recorded() const { return recorder_.path().size(); }
    bool replaying() const { return replayStart_.has_value(); }
    bool preview() const { return preview_; }
    // What to tell the person, and since when.
    const std::string& note() const { return note_; }
    double noteTime() const { return noteTime_; }

    // Radians.
    void turn(double right, double up);
    void beginOrbit();
    void orbit(double right, double up);
    void changeSpeed(double wheelSteps);
    void goHome();
    void toggleWalking();
    void recallView(std::size_t number);
    void saveView(std::size_t number);
    void toggleRecording();
    void toggleReplay();
    void togglePreview();
    // Hands control over, or gets in line for it.
    void toggleControl();
    void change(const std::string& setting, const std::string& value);
    // The next of the values that a setting of the form a|b|c has.
    void changeToNext(const std::string& setting);
    std::string value(const std::string& setting) const;

    // Writes what was recorded, if a file was asked for.
    Result<void> finish();

  private:
    void meet();
    void follow();
    void replay(double now);
    bool mayMove();
    void tell(std::string note);

    const Options options_;
    Session& session_;
    SavedViews views_;
    WallState wall_;
    std::shared_ptr<const protocol::FrameDone> seen_;  // the frame that was looked at last
    std::optional<Navigator> navigator_;
    std::shared_ptr<const protocol::Welcome> met_;  // the wall that it is of
    std::optional<Camera> sent_;
    double now_ = 0;
    bool moves_ = false;
    bool wishesControl_ = true, preview_;
    bool recording_ = false;
    Recorder recorder_;
    std::optional<double> replayStart_;
    std::string note_;
    double noteTime_ = 0;
};

// "flat|smooth|auto": the three; empty for a form that is none of choices.
std::vector<std::string> choicesOf(const std::string& form);

}  // namespace iwalk::client
