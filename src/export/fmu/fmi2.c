/* FMI 2.0, Model Exchange and Co-Simulation: https://fmi-standard.org */
#include "core.h"

#include <string.h>

/* The types of the interface, under names of our own: the header of an importer may stand before this file. */
typedef enum { STATUS_OK, STATUS_WARNING, STATUS_DISCARD, STATUS_ERROR, STATUS_FATAL, STATUS_PENDING } Status;
typedef enum { MODEL_EXCHANGE, CO_SIMULATION } Kind;
typedef void (*Logger)(void *environment, const char *instance, Status status, const char *category, const char *message,
                       ...);

typedef struct {
    Logger logger;
    void *(*allocate)(size_t count, size_t size);
    void (*release)(void *memory);
    void (*step_finished)(void *environment, Status status);
    void *environment;
} Callbacks;

typedef struct {
    int new_discrete_states_needed, terminate, nominals_changed, states_changed, next_event_defined;
    double next_event;
} EventInfo;

typedef struct {
    Core core;
    Callbacks callbacks;
    int logs;
    char name[128];
} Instance;

static Status said(Instance *of, int result)
{
    if (result == OK)
        return STATUS_OK;
    if (of->logs && of->callbacks.logger)
        of->callbacks.logger(of->callbacks.environment, of->name, STATUS_ERROR, "logStatusError", "%s",
                             core_message(result));
    return result == NOT_FINITE || result == TOO_STIFF ? STATUS_DISCARD : STATUS_ERROR;
}

#define OF_VERSION(name) fmi2##name
#ifdef FMI2_FUNCTION_PREFIX
#define FUNCTION_PREFIX FMI2_FUNCTION_PREFIX
#endif
/* How this version names the functions of saved states, and how it allocates memory for them. */
#define GET_STATE fmi2GetFMUstate
#define SET_STATE fmi2SetFMUstate
#define FREE_STATE fmi2FreeFMUstate
#define SERIALIZED_STATE_SIZE fmi2SerializedFMUstateSize
#define SERIALIZE_STATE fmi2SerializeFMUstate
#define DESERIALIZE_STATE fmi2DeSerializeFMUstate
#define ALLOCATE(of, size) ((of)->callbacks.allocate(1, size))
#define RELEASE(of, memory) ((of)->callbacks.release(memory))
typedef char Byte;
#include "interface.h"

EXPORT const char *FMI(fmi2GetTypesPlatform)(void) { return "default"; }
EXPORT const char *FMI(fmi2GetVersion)(void) { return "2.0"; }

EXPORT Status FMI(fmi2SetDebugLogging)(void *c, int on, size_t count, const char *const categories[])
{
    (void)count;
    (void)categories;
    ((Instance *)c)->logs = on;
    return STATUS_OK;
}

EXPORT void *FMI(fmi2Instantiate)(const char *name, Kind kind, const char *token, const char *resources,
                           const Callbacks *callbacks, int visible, int logs)
{
    Instance *of;
    (void)kind;
    (void)resources;
    (void)visible;
    if (!callbacks || !callbacks->allocate || !callbacks->release || !token || strcmp(token, TOKEN) != 0) {
        if (callbacks && callbacks->logger)
            callbacks->logger(callbacks->environment, name, STATUS_ERROR, "logStatusError",
                              "the GUID is not that of modelDescription.xml, or memory callbacks are missing");
        return NULL;
    }
    of = callbacks->allocate(1, sizeof *of);
    if (!of)
        return NULL;
    memset(of, 0, sizeof *of);
    of->callbacks = *callbacks;
    of->logs = logs;
    if (name)
        strncpy(of->name, name, sizeof of->name - 1);
    core_reset(&of->core);
    return of;
}

EXPORT void FMI(fmi2FreeInstance)(void *c)
{
    if (c)
        ((Instance *)c)->callbacks.release(c);
}

EXPORT Status FMI(fmi2SetupExperiment)(void *c, int tolerance_defined, double tolerance, double start,
                                       int stop_defined, double stop)
{
    (void)stop_defined;
    (void)stop;
    core_begin(&((Instance *)c)->core, start, tolerance_defined ? tolerance : TOLERANCE);
    return STATUS_OK;
}

EXPORT Status FMI(fmi2EnterInitializationMode)(void *c) { (void)c; return STATUS_OK; }

EXPORT Status FMI(fmi2GetReal)(void *c, const unsigned int references[], size_t count, double values[])
{
    size_t i;
    int result = OK;
    for (i = 0; i < count && result == OK; i++)
        result = core_get(&((Instance *)c)->core, references[i], &values[i]);
    return said(c, result);
}

EXPORT Status FMI(fmi2SetReal)(void *c, const unsigned int references[], size_t count, const double values[])
{
    size_t i;
    int result = OK;
    for (i = 0; i < count && result == OK; i++)
        result = core_set(&((Instance *)c)->core, references[i], values[i]);
    return said(c, result);
}

/* There are no variables but real ones. */
#define NONE_OF(name, type)                                                                                             \
    EXPORT Status FMI(name)(void *c, const unsigned int references[], size_t count, type values[])                            \
    {                                                                                                                   \
        (void)references;                                                                                               \
        (void)values;                                                                                                   \
        return none(c, count);                                                                                          \
    }
NONE_OF(fmi2GetInteger, int)
NONE_OF(fmi2GetBoolean, int)
NONE_OF(fmi2GetString, const char *)
NONE_OF(fmi2SetInteger, const int)
NONE_OF(fmi2SetBoolean, const int)
NONE_OF(fmi2SetString, const char *const)

EXPORT Status FMI(fmi2GetDirectionalDerivative)(void *c, const unsigned int unknown[], size_t unknowns,
                                         const unsigned int known[], size_t knowns, const double seed[],
                                         double sensitivity[])
{
    return said(c, core_directional(&((Instance *)c)->core, unknown, unknowns, known, knowns, seed, sensitivity));
}

/* Model Exchange. */


/* A law that bends has no memory of its bend: nothing has to be done at an event. */
EXPORT Status FMI(fmi2NewDiscreteStates)(void *c, EventInfo *info)
{
    (void)c;
    memset(info, 0, sizeof *info);
    return STATUS_OK;
}

EXPORT Status FMI(fmi2CompletedIntegratorStep)(void *c, int no_set_state, int *enter_event_mode, int *terminate)
{
    (void)c;
    (void)no_set_state;
    *enter_event_mode = 0;
    *terminate = 0;
    return STATUS_OK;
}

EXPORT Status FMI(fmi2GetDerivatives)(void *c, double dx[], size_t count)
{
    return said(c, core_get_derivatives(&((Instance *)c)->core, dx, count));
}

/* Co-Simulation. */

EXPORT Status FMI(fmi2SetRealInputDerivatives)(void *c, const unsigned int references[], size_t count, const int orders[],
                                        const double values[])
{
    size_t i;
    int result = OK;
    for (i = 0; i < count && result == OK; i++)
        result = orders[i] == 1 ? core_set_rate(&((Instance *)c)->core, references[i], values[i]) : UNKNOWN_VARIABLE;
    return said(c, result);
}

EXPORT Status FMI(fmi2GetRealOutputDerivatives)(void *c, const unsigned int references[], size_t count, const int orders[],
                                         double values[])
{
    (void)references;
    (void)orders;
    (void)values;
    return none(c, count);
}

EXPORT Status FMI(fmi2DoStep)(void *c, double from, double duration, int no_set_state)
{
    Core *core = &((Instance *)c)->core;
    (void)no_set_state;
    core->now.time = from;
    return said(c, core_advance(core, duration));
}

/* A step ends before its call returns. */
EXPORT Status FMI(fmi2CancelStep)(void *c) { (void)c; return STATUS_ERROR; }
EXPORT Status FMI(fmi2GetStatus)(void *c, int kind, Status *value) { (void)c; (void)kind; (void)value; return STATUS_DISCARD; }

EXPORT Status FMI(fmi2GetRealStatus)(void *c, int kind, double *value)
{
    if (kind != 2)
        return STATUS_DISCARD;
    *value = ((Instance *)c)->core.now.time;
    return STATUS_OK;
}

EXPORT Status FMI(fmi2GetIntegerStatus)(void *c, int kind, int *value) { (void)c; (void)kind; (void)value; return STATUS_DISCARD; }

EXPORT Status FMI(fmi2GetBooleanStatus)(void *c, int kind, int *value)
{
    (void)c;
    if (kind != 3)
        return STATUS_DISCARD;
    *value = 0;
    return STATUS_OK;
}

EXPORT Status FMI(fmi2GetStringStatus)(void *c, int kind, const char **value)
{
    (void)c;
    (void)kind;
    (void)value;
    return STATUS_DISCARD;
}
