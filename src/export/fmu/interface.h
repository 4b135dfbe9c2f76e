/* What FMI 2.0 and 3.0 have in common: how functions are exported, and functions that differ in their names alone. A version
 * includes it after its Status, its Instance, said() and the names and memory functions of saved states. */

#if defined _WIN32 || defined __CYGWIN__
#define EXPORT __declspec(dllexport)
#elif defined __GNUC__
#define EXPORT __attribute__((visibility("default")))
#else
#define EXPORT
#endif

/* Functions that are linked together with those of other FMUs begin with the name of the model. */
#ifdef FUNCTION_PREFIX
#define JOINED(prefix, name) prefix##name
#define JOIN(prefix, name) JOINED(prefix, name)
#define FMI(name) JOIN(FUNCTION_PREFIX, name)
#else
#define FMI(name) name
#endif

/* There is nothing of a kind. */
static Status none(Instance *of, size_t count)
{
    return said(of, count == 0 ? OK : UNKNOWN_VARIABLE);
}

EXPORT Status FMI(OF_VERSION(ExitInitializationMode))(void *c) { (void)c; return STATUS_OK; }
EXPORT Status FMI(OF_VERSION(EnterEventMode))(void *c) { (void)c; return STATUS_OK; }
EXPORT Status FMI(OF_VERSION(EnterContinuousTimeMode))(void *c) { (void)c; return STATUS_OK; }
EXPORT Status FMI(OF_VERSION(Terminate))(void *c) { (void)c; return STATUS_OK; }

EXPORT Status FMI(OF_VERSION(Reset))(void *c)
{
    core_reset(&((Instance *)c)->core);
    return STATUS_OK;
}

EXPORT Status FMI(OF_VERSION(SetTime))(void *c, double time)
{
    ((Instance *)c)->core.now.time = time;
    return STATUS_OK;
}

EXPORT Status FMI(OF_VERSION(SetContinuousStates))(void *c, const double x[], size_t count)
{
    return said(c, core_set_states(&((Instance *)c)->core, x, count));
}

EXPORT Status FMI(OF_VERSION(GetContinuousStates))(void *c, double x[], size_t count)
{
    return said(c, core_get_states(&((Instance *)c)->core, x, count));
}

EXPORT Status FMI(OF_VERSION(GetEventIndicators))(void *c, double indicators[], size_t count)
{
    return said(c, core_get_kinks(&((Instance *)c)->core, indicators, count));
}

EXPORT Status FMI(OF_VERSION(GetNominalsOfContinuousStates))(void *c, double nominals[], size_t count)
{
    return said(c, core_get_nominals(nominals, count));
}

/* Copies a snapshot to a state, which is allocated if there is none. */
static Status save(Instance *of, const void *snapshot, void **state)
{
    (void)of;
    if (!*state)
        *state = ALLOCATE(of, sizeof(Snapshot));
    if (!*state)
        return STATUS_ERROR;
    memcpy(*state, snapshot, sizeof(Snapshot));
    return STATUS_OK;
}

EXPORT Status FMI(GET_STATE)(void *c, void **state)
{
    return save(c, &((Instance *)c)->core.now, state);
}

EXPORT Status FMI(SET_STATE)(void *c, void *state)
{
    core_restore(&((Instance *)c)->core, state);
    return STATUS_OK;
}

EXPORT Status FMI(FREE_STATE)(void *c, void **state)
{
    (void)c;
    if (*state)
        RELEASE((Instance *)c, *state);
    *state = NULL;
    return STATUS_OK;
}

EXPORT Status FMI(SERIALIZED_STATE_SIZE)(void *c, void *state, size_t *size)
{
    (void)c;
    (void)state;
    *size = sizeof(Snapshot);
    return STATUS_OK;
}

EXPORT Status FMI(SERIALIZE_STATE)(void *c, void *state, Byte bytes[], size_t size)
{
    (void)c;
    if (size < sizeof(Snapshot))
        return STATUS_ERROR;
    memcpy(bytes, state, sizeof(Snapshot));
    return STATUS_OK;
}

EXPORT Status FMI(DESERIALIZE_STATE)(void *c, const Byte bytes[], size_t size, void **state)
{
    return size < sizeof(Snapshot) ? STATUS_ERROR : save(c, bytes, state);
}
