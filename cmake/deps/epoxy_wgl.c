/* libepoxy for WGL, linked statically. Its DLL has a table of functions for each thread, which its DllMain
   allocates. Here all threads share one, because they share a driver. */
#define gl_init_dispatch_table epoxy_no_table
#define gl_switch_to_dispatch_table epoxy_no_table
#define wgl_init_dispatch_table epoxy_no_table
#define wgl_switch_to_dispatch_table epoxy_no_table
#define DllMain epoxy_dll_main
#include <dispatch_wgl.c>

void epoxy_no_table(void) {}
