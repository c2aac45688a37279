#include "client/fly/flight.hpp"

#include <algorithm>

#include "common/settings.hpp"

namespace iwalk::client {
namespace {

constexpr double kStepAfterRest = 1.0 / 60;  // s

// Of all tiles: the nearest of the nearest, and the median of the middles.
void lookAt(const protocol::FrameDone& frame, Navigator& navigator) {
    double near = 0;
    std::vector<double> middles;
    for (const protocol::TileStats& tile : frame.tiles) {
        if (!(tile.nearDepth > 0 && tile.midDepth > 0)) continue;
        near = near > 0 ? std::min(near, tile.nearDepth) : tile.nearDepth;
        middles.push_back(tile.midDepth);
    }
    if (middles.empty()) return navigator.seeSurfaces(0, 0);
    const auto middle = middles.begin() + static_cast<std::ptrdiff_t>(middles.size() / 2);
    std::nth_element(middles.begin(), middle, middles.end());
    navigator.seeSurfaces(near, *middle);
}

bool anyOf(const Motion& motion) {
    return motion.right != 0 || motion.up != 0 || motion.forward != 0;
}

}  // namespace

std::vector<std::string> choicesOf(const std::string& form) {
    std::vector<std::string> choices;
    if (form.find('|') == std::string::npos) return choices;
    for (std::size_t begin = 0; begin <= form.size();) {
        const std::size_t end = std::min(form.find('|', begin), form.size());
        choices.push_back(form.substr(begin, end - begin));
        begin = end + 1;
    }
    // "L|full" has a word that stands for others.
    const bool words = std::all_of(choices.begin(), choices.end(), [](const std::string& choice) {
        return !choice.empty() && choice.front() >= 'a' && choice.front() <= 'z';
    });
    return words ? choices : std::vector<std::string>();
}

Flight::Flight(const Options& options, Session& session, SavedViews views)
    : options_(options),
      session_(session),
      views_(std::move(views)),
      preview_(options.preview),
      recording_(!options.record.empty()) {}

bool Flight::step(double now, const Motion& wanted) {
    // After a rest the first step is short: the time before it was not spent moving.
    const double seconds = moves_ ? now - now_ : std::min(now - now_, kStepAfterRest);
    now_ = now;
    moves_ = false;
    wall_ = session_.state();
    if (!wall_.welcome) return false;
    meet();
    if (!navigator_) return false;
    follow();
    if (!steers()) return false;

    if (replayStart_ && anyOf(wanted)) replayStart_.reset();
    moves_ = replayStart_ ? (replay(now), true) : navigator_->move(wanted, seconds);
    // What servers say of distances goes into cameras.
    if (!checkCamera(navigator_->camera())) navigator_->go(navigator_->homeView());
    if (navigator_->camera() != sent_ && checkCamera(navigator_->camera())) {
        sent_ = navigator_->camera();
        session_.setCamera(*sent_);
        if (recording_) recorder_.add(now, *sent_);
    }
    return moves_;
}

// A wall that is met for the first time: where it is already counts; else all of the model is shown.
void Flight::meet() {
    const ModelBox& bounds = wall_.welcome->bounds;
    if (!wall_.told || (navigator_ && met_->bounds == bounds)) return;
    met_ = wall_.welcome;
    const protocol::FrameDone* frame = wall_.frame.get();
    navigator_.emplace(bounds, options_.up, options_.fovY.value_or(frame ? frame->camera.fovY : 60));
    sent_.reset();
    if (!frame) return;
    navigator_->go(frame->camera);
    if (!options_.fovY) sent_ = frame->camera;
}

// What the servers say of their pictures; and who does not steer goes where the other one goes.
void Flight::follow() {
    if (!wall_.frame || wall_.frame == seen_) return;
    seen_ = wall_.frame;
    lookAt(*seen_, *navigator_);
    if (!wall_.connected || !wall_.told || wall_.control) return;
    navigator_->setFovY(seen_->camera.fovY);
    navigator_->go(seen_->camera);
    sent_ = seen_->camera;
}

void Flight::replay(double now) {
    if (const Camera* camera = replayed(recorder_.path(), now - *replayStart_))
        return navigator_->go(*camera);
    replayStart_.reset();
    tell("the replay has ended");
}

void Flight::tell(std::string note) {
    note_ = std::move(note);
    noteTime_ = now_;
}

bool Flight::mayMove() {
    if (!steers()) return false;
    replayStart_.reset();
    return true;
}

void Flight::turn(double right, double up) {
    if (mayMove()) navigator_->turn(right, up);
}

void Flight::beginOrbit() {
    if (mayMove()) navigator_->beginOrbit();
}

void Flight::orbit(double right, double up) {
    if (mayMove()) navigator_->orbit(right, up);
}

void Flight::changeSpeed(double wheelSteps) {
    if (!navigator_) return;
    navigator_->changeSpeed(wheelSteps);
    tell(fmt::format("speed: {:.3g} units a second here", navigator_->speed()));
}

void Flight::goHome() {
    if (mayMove()) navigator_->go(navigator_->homeView());
}

void Flight::toggleWalking() {
    if (!navigator_) return;
    navigator_->setWalking(!navigator_->walking());
    tell(navigator_->walking() ? "walking: the height stays" : "flying");
}

void Flight::recallView(std::size_t number) {
    if (!navigator_) return;
    const std::optional<Camera>& view = views_.view(number);
    if (!view) return tell(fmt::format("there is no view {0} yet: Ctrl+{0} keeps one", (number + 1) % 10));
    if (mayMove()) navigator_->go(*view);
}

void Flight::saveView(std::size_t number) {
    if (!navigator_) return;
    const Result<void> saved = views_.save(number, navigator_->camera(), navigator_->homeView());
    tell(saved ? fmt::format("view {} is kept in {}", (number + 1) % 10, views_.file())
               : saved.error().message);
}

void Flight::toggleRecording() {
    recording_ = !recording_;
    if (recording_) {
        recorder_ = {};
        return tell("recording: R ends it");
    }
    const Result<void> written = finish();
    if (!written) return tell(written.error().message);
    tell(fmt::format("{} frames recorded{}; P plays them", recorded(),
                     options_.record.empty() ? "" : fmt::format(", in {}", options_.record)));
}

void Flight::toggleReplay() {
    if (replayStart_) return replayStart_.reset();
    if (recorder_.path().empty()) return tell("nothing is recorded yet: R begins");
    if (recording_) toggleRecording();
    if (mayMove()) replayStart_ = now_;
}

void Flight::togglePreview() {
    preview_ = !preview_;
    session_.wishPreview(preview_);
}

void Flight::toggleControl() {
    wishesControl_ = !wishesControl_;
    session_.wishControl(wishesControl_);
    tell(wishesControl_ ? "waiting for control" : "control is handed over; C asks for it again");
}

void Flight::change(const std::string& setting, const std::string& value) {
    if (!steers()) return tell("who does not steer cannot change settings");
    session_.changeSetting(setting, value);
    tell(fmt::format("{} = {}", setting, value));
}

void Flight::changeToNext(const std::string& setting) {
    for (const SettingInfo& info : settingTable()) {
        if (info.name != setting) continue;
        const std::vector<std::string> choices = choicesOf(info.form);
        const auto found = std::find(choices.begin(), choices.end(), value(setting));
        if (found != choices.end()) change(setting, found + 1 == choices.end() ? choices.front() : found[1]);
    }
}

std::string Flight::value(const std::string& setting) const {
    for (const protocol::NamedValue& each : wall_.settings)
        if (each.name == setting) return each.value;
    return "";
}

Result<void> Flight::finish() {
    if (options_.record.empty() || recorder_.path().empty()) return {};
    std::vector<Camera> path = recorder_.path();
    for (Camera& camera : path) camera.fovY = path.front().fovY;  // the file has one
    return saveCameraPath(options_.record, path);
}

}  // namespace iwalk::client
