/* FMI 3.0, Model Exchange and Co-Simulation: https://fmi-standard.org */
#include "core.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

typedef enum { STATUS_OK, STATUS_WARNING, STATUS_DISCARD, STATUS_ERROR, STATUS_FATAL } Status;
typedef void (*Logger)(void *environment, Status status, const char *category, const char *message);
/* What an importer is called back with; nothing here calls it. */
typedef void (*Callback)(void);

typedef struct {
    Core core;
    Logger logger;
    void *environment;
    bool logs;
} Instance;

static Status said(Instance *of, int result)
{
    if (result == OK)
        return STATUS_OK;
    if (of->logs && of->logger)
        of->logger(of->environment, STATUS_ERROR, "logStatusError", core_message(result));
    return result == NOT_FINITE || result == TOO_STIFF ? STATUS_DISCARD : STATUS_ERROR;
}

#define OF_VERSION(name) fmi3##name
#ifdef FMI3_FUNCTION_PREFIX
#define FUNCTION_PREFIX FMI3_FUNCTION_PREFIX
#endif
/* How this version names the functions of saved states, and how it allocates memory for them. */
#define GET_STATE fmi3GetFMUState
#define SET_STATE fmi3SetFMUState
#define FREE_STATE fmi3FreeFMUState
#define SERIALIZED_STATE_SIZE fmi3SerializedFMUStateSize
#define SERIALIZE_STATE fmi3SerializeFMUState
#define DESERIALIZE_STATE fmi3DeserializeFMUState
#define ALLOCATE(of, size) malloc(size)
#define RELEASE(of, memory) free(memory)
typedef uint8_t Byte;
#include "interface.h"

EXPORT const char *FMI(fmi3GetVersion)(void) { return "3.0"; }

EXPORT Status FMI(fmi3SetDebugLogging)(void *c, bool on, size_t count, const char *const categories[])
{
    (void)count;
    (void)categories;
    ((Instance *)c)->logs = on;
    return STATUS_OK;
}

static void *instantiate(const char *token, bool logs, void *environment, Logger logger)
{
    Instance *of;
    if (!token || strcmp(token, TOKEN) != 0) {
        if (logger)
            logger(environment, STATUS_ERROR, "logStatusError", "the token is not that of modelDescription.xml");
        return NULL;
    }
    of = calloc(1, sizeof *of);
    if (!of)
        return NULL;
    of->logger = logger;
    of->environment = environment;
    of->logs = logs;
    core_reset(&of->core);
    return of;
}

EXPORT void *FMI(fmi3InstantiateModelExchange)(const char *name, const char *token, const char *resources, bool visible,
                                               bool logs, void *environment, Logger logger)
{
    (void)name;
    (void)resources;
    (void)visible;
    return instantiate(token, logs, environment, logger);
}

EXPORT void *FMI(fmi3InstantiateCoSimulation)(const char *name, const char *token, const char *resources, bool visible,
                                              bool logs, bool event_mode, bool early_return,
                                              const uint32_t intermediate[], size_t count, void *environment,
                                              Logger logger, Callback update)
{
    (void)name;
    (void)resources;
    (void)visible;
    (void)event_mode;
    (void)early_return;
    (void)intermediate;
    (void)count;
    (void)update;
    return instantiate(token, logs, environment, logger);
}

EXPORT void *FMI(fmi3InstantiateScheduledExecution)(const char *name, const char *token, const char *resources,
                                                    bool visible, bool logs, void *environment, Logger logger,
                                                    Callback update, Callback lock, Callback unlock)
{
    (void)name;
    (void)token;
    (void)resources;
    (void)visible;
    (void)logs;
    (void)environment;
    (void)logger;
    (void)update;
    (void)lock;
    (void)unlock;
    return NULL;
}

EXPORT void FMI(fmi3FreeInstance)(void *c) { free(c); }

EXPORT Status FMI(fmi3EnterInitializationMode)(void *c, bool tolerance_defined, double tolerance, double start,
                                               bool stop_defined, double stop)
{
    (void)stop_defined;
    (void)stop;
    core_begin(&((Instance *)c)->core, start, tolerance_defined ? tolerance : TOLERANCE);
    return STATUS_OK;
}

EXPORT Status FMI(fmi3EnterStepMode)(void *c) { (void)c; return STATUS_OK; }
EXPORT Status FMI(fmi3EnterConfigurationMode)(void *c) { (void)c; return STATUS_OK; }
EXPORT Status FMI(fmi3ExitConfigurationMode)(void *c) { (void)c; return STATUS_OK; }

EXPORT Status FMI(fmi3GetFloat64)(void *c, const uint32_t references[], size_t count, double values[], size_t values_of)
{
    size_t i;
    int result = count == values_of ? OK : UNKNOWN_VARIABLE;
    for (i = 0; i < count && result == OK; i++)
        result = core_get(&((Instance *)c)->core, references[i], &values[i]);
    return said(c, result);
}

EXPORT Status FMI(fmi3SetFloat64)(void *c, const uint32_t references[], size_t count, const double values[],
                                  size_t values_of)
{
    size_t i;
    int result = count == values_of ? OK : UNKNOWN_VARIABLE;
    for (i = 0; i < count && result == OK; i++)
        result = core_set(&((Instance *)c)->core, references[i], values[i]);
    return said(c, result);
}

/* There are no variables but of double precision. */
#define NONE_OF(name, type)                                                                                            \
    EXPORT Status FMI(name)(void *c, const uint32_t references[], size_t count, type values[], size_t values_of)      \
    {                                                                                                                  \
        (void)references;                                                                                              \
        (void)values;                                                                                                  \
        (void)values_of;                                                                                               \
        return none(c, count);                                                                                         \
    }
NONE_OF(fmi3GetFloat32, float)
NONE_OF(fmi3GetInt8, int8_t)
NONE_OF(fmi3GetUInt8, uint8_t)
NONE_OF(fmi3GetInt16, int16_t)
NONE_OF(fmi3GetUInt16, uint16_t)
NONE_OF(fmi3GetInt32, int32_t)
NONE_OF(fmi3GetUInt32, uint32_t)
NONE_OF(fmi3GetInt64, int64_t)
NONE_OF(fmi3GetUInt64, uint64_t)
NONE_OF(fmi3GetBoolean, bool)
NONE_OF(fmi3GetString, const char *)
NONE_OF(fmi3SetFloat32, const float)
NONE_OF(fmi3SetInt8, const int8_t)
NONE_OF(fmi3SetUInt8, const uint8_t)
NONE_OF(fmi3SetInt16, const int16_t)
NONE_OF(fmi3SetUInt16, const uint16_t)
NONE_OF(fmi3SetInt32, const int32_t)
NONE_OF(fmi3SetUInt32, const uint32_t)
NONE_OF(fmi3SetInt64, const int64_t)
NONE_OF(fmi3SetUInt64, const uint64_t)
NONE_OF(fmi3SetBoolean, const bool)
NONE_OF(fmi3SetString, const char *const)

EXPORT Status FMI(fmi3GetBinary)(void *c, const uint32_t references[], size_t count, size_t sizes[],
                                 const uint8_t *values[], size_t values_of)
{
    (void)references;
    (void)sizes;
    (void)values;
    (void)values_of;
    return none(c, count);
}

EXPORT Status FMI(fmi3SetBinary)(void *c, const uint32_t references[], size_t count, const size_t sizes[],
                                 const uint8_t *const values[], size_t values_of)
{
    (void)references;
    (void)sizes;
    (void)values;
    (void)values_of;
    return none(c, count);
}

/* There are no clocks. */
#define NO_CLOCK(name, type)                                                                                           \
    EXPORT Status FMI(name)(void *c, const uint32_t references[], size_t count, type values[])                        \
    {                                                                                                                  \
        (void)references;                                                                                              \
        (void)values;                                                                                                  \
        return none(c, count);                                                                                         \
    }
NO_CLOCK(fmi3GetClock, bool)
NO_CLOCK(fmi3SetClock, const bool)
NO_CLOCK(fmi3GetShiftDecimal, double)
NO_CLOCK(fmi3SetShiftDecimal, const double)
NO_CLOCK(fmi3SetIntervalDecimal, const double)

#define NO_CLOCK_EITHER(name, type, other)                                                                             \
    EXPORT Status FMI(name)(void *c, const uint32_t references[], size_t count, type values[], other more[])          \
    {                                                                                                                  \
        (void)references;                                                                                              \
        (void)values;                                                                                                  \
        (void)more;                                                                                                    \
        return none(c, count);                                                                                         \
    }
NO_CLOCK_EITHER(fmi3GetIntervalDecimal, double, int)
NO_CLOCK_EITHER(fmi3SetIntervalFraction, const uint64_t, const uint64_t)
NO_CLOCK_EITHER(fmi3GetShiftFraction, uint64_t, uint64_t)
NO_CLOCK_EITHER(fmi3SetShiftFraction, const uint64_t, const uint64_t)

EXPORT Status FMI(fmi3GetIntervalFraction)(void *c, const uint32_t references[], size_t count, uint64_t counters[],
                                           uint64_t resolutions[], int qualifiers[])
{
    (void)references;
    (void)counters;
    (void)resolutions;
    (void)qualifiers;
    return none(c, count);
}

EXPORT Status FMI(fmi3ActivateModelPartition)(void *c, uint32_t clock, double time)
{
    (void)clock;
    (void)time;
    return none(c, 1);
}

/* Dependencies do not change: modelDescription.xml has them. */
EXPORT Status FMI(fmi3GetNumberOfVariableDependencies)(void *c, uint32_t reference, size_t *count)
{
    (void)reference;
    (void)count;
    return none(c, 1);
}

EXPORT Status FMI(fmi3GetVariableDependencies)(void *c, uint32_t dependent, size_t of_dependent[],
                                               uint32_t independents[], size_t of_independents[], int kinds[],
                                               size_t count)
{
    (void)dependent;
    (void)of_dependent;
    (void)independents;
    (void)of_independents;
    (void)kinds;
    return none(c, count + 1);
}

EXPORT Status FMI(fmi3GetDirectionalDerivative)(void *c, const uint32_t unknown[], size_t unknowns,
                                                const uint32_t known[], size_t knowns, const double seed[],
                                                size_t seeds, double sensitivity[], size_t sensitivities)
{
    if (seeds != knowns || sensitivities != unknowns)
        return said(c, UNKNOWN_VARIABLE);
    return said(c, core_directional(&((Instance *)c)->core, unknown, unknowns, known, knowns, seed, sensitivity));
}

EXPORT Status FMI(fmi3GetAdjointDerivative)(void *c, const uint32_t unknown[], size_t unknowns, const uint32_t known[],
                                            size_t knowns, const double seed[], size_t seeds, double sensitivity[],
                                            size_t sensitivities)
{
    (void)unknown;
    (void)unknowns;
    (void)known;
    (void)knowns;
    (void)seed;
    (void)seeds;
    (void)sensitivity;
    (void)sensitivities;
    return none(c, 1);
}

/* A law that bends has no memory of its bend: nothing has to be done at an event. */
EXPORT Status FMI(fmi3EvaluateDiscreteStates)(void *c) { (void)c; return STATUS_OK; }

EXPORT Status FMI(fmi3UpdateDiscreteStates)(void *c, bool *need_update, bool *terminate, bool *nominals_changed,
                                            bool *states_changed, bool *next_event_defined, double *next_event)
{
    (void)c;
    *need_update = *terminate = *nominals_changed = *states_changed = *next_event_defined = false;
    *next_event = 0.0;
    return STATUS_OK;
}

/* Model Exchange. */

EXPORT Status FMI(fmi3CompletedIntegratorStep)(void *c, bool no_set_state, bool *enter_event_mode, bool *terminate)
{
    (void)c;
    (void)no_set_state;
    *enter_event_mode = *terminate = false;
    return STATUS_OK;
}

EXPORT Status FMI(fmi3GetContinuousStateDerivatives)(void *c, double dx[], size_t count)
{
    return said(c, core_get_derivatives(&((Instance *)c)->core, dx, count));
}

EXPORT Status FMI(fmi3GetNumberOfEventIndicators)(void *c, size_t *count)
{
    (void)c;
    *count = KINKS;
    return STATUS_OK;
}

EXPORT Status FMI(fmi3GetNumberOfContinuousStates)(void *c, size_t *count)
{
    (void)c;
    *count = STATES;
    return STATUS_OK;
}

/* Co-Simulation. */

EXPORT Status FMI(fmi3GetOutputDerivatives)(void *c, const uint32_t references[], size_t count, const int32_t orders[],
                                            double values[], size_t values_of)
{
    (void)references;
    (void)orders;
    (void)values;
    (void)values_of;
    return none(c, count);
}

EXPORT Status FMI(fmi3DoStep)(void *c, double from, double duration, bool no_set_state, bool *event_needed,
                              bool *terminate, bool *early_return, double *last_time)
{
    int result;
    Core *core = &((Instance *)c)->core;
    (void)no_set_state;
    core->now.time = from;
    result = core_advance(core, duration);
    *event_needed = *terminate = *early_return = false;
    *last_time = core->now.time;
    return said(c, result);
}
