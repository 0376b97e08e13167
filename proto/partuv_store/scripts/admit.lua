-- May a submission begin? ARGV: owner, bytes announced, budget, queue limit, jobs per owner.
-- Returns '' or the code of the refusal. 'submit' decides again when the upload is there.
local bytes, budget = tonumber(ARGV[2]), tonumber(ARGV[3])
if budget > 0 and stored_bytes() + bytes > budget then return 'store_full' end
local queue_limit, owner_limit = tonumber(ARGV[4]), tonumber(ARGV[5])
if queue_limit > 0 and redis.call('ZCARD', key('waiting')) >= queue_limit then return 'queue_full' end
if owner_limit > 0 and redis.call('SCARD', key('active', ARGV[1])) >= owner_limit then
  return 'too_many_jobs'
end
return ''
