/* The model once more, under other names, for a compilation with other options. */
#define model_process fast_process
#define model_recv fast_recv
#define model_send fast_send
#include "../deltarobot/model/model.c"
