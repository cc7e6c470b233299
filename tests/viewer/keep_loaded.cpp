// Preloaded before a program under the leak sanitizer: libraries stay loaded to the end, so that
// what they leak carries their name and can be told from what is ours.
extern "C" int dlclose(void*) { return 0; }
