// Linked under ThreadSanitizer only: runs Embree's parallel functions on the calling thread.
//
// Debian's Embree is not instrumented. The end of its parallel loops is invisible to ThreadSanitizer, so that every
// later write to what a callback has read would be reported. These definitions stand before those of libembree3.
#include <dlfcn.h>
#include <embree3/rtcore.h>
#include <tbb/task_arena.h>

#include <cstdlib>

namespace {

template <class Function, class... Arguments>
void run_serially(Function* stand_in, const char* name, Arguments... arguments) {
  Function* const real = reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
  if (real == nullptr || real == stand_in) std::abort();
  tbb::task_arena(1).execute([&] { real(arguments...); });
}

}  // namespace

void rtcCommitScene(RTCScene scene) { run_serially(&rtcCommitScene, "rtcCommitScene", scene); }

void rtcCollide(RTCScene scene0, RTCScene scene1, RTCCollideFunc callback, void* user) {
  run_serially(&rtcCollide, "rtcCollide", scene0, scene1, callback, user);
}
